"""Inputs as people get them wrong, by the kind of the slip: what is answered to each.

A field is at fault by its pointer and code; the answer has the rule, the value and the repair in
its words, of which the figures and names are listed here.
"""

import copy
import json
from dataclasses import dataclass
from typing import Any

from tests.conftest import CRANE
from tests.shapersmith.requests import REQUESTS

TEXT = json.dumps(CRANE, indent=1)
"""The crane with a field a line; ``cable_length_m`` is on the fourth."""

FOLLOWED = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05}
MODE = {"kind": "mode", "natural_frequency_rad_s": 3.5}
SPRING = {"kind": "spring_mass", "mass_kg": 1.0, "stiffness_n_m": 10.0}
LEFT_OUT = object()


@dataclass(frozen=True, kw_only=True)
class Faulty:
    """An input with one fault.

    Attributes
    ----------
    slip
        What kind of a slip it is.
    body
        What is sent, or stands in the file.
    operation
        What it is a request of.
    code, pointer
        What programs get of it.
    told
        Parts of the answer: of rule and value, and the repair last.
    file_is_read
        Whether the command line reads it from a file all the same.
    """

    slip: str
    body: bytes
    code: str
    told: tuple[str, ...]
    pointer: str = ""
    operation: str = "design"
    file_is_read: bool = False


def with_fault(
    slip: str, where: str, value: Any, code: str, *told: str, plant: Any = None, **changed: Any
) -> Faulty:
    """Return a request in which one field is wrong; ``operation`` and ``actuator`` may be given."""
    operation = changed.pop("operation", "design")
    request = copy.deepcopy(REQUESTS[operation] if operation != "design" else dict(CRANE))
    request.update({"plant": plant} if plant else {}, **changed)
    request = copy.deepcopy(request)
    *path, last = where.strip("/").split("/")
    here = request
    for step in path:
        here = here[int(step)] if isinstance(here, list) else here.setdefault(step, {})
    if value is LEFT_OUT:
        del here[last]
    else:
        here[last] = value
    body = json.dumps(request).encode()
    return Faulty(slip=slip, body=body, code=code, told=told, pointer=where, operation=operation)


def with_text(slip: str, right: str, wrong: str, *told: str) -> Faulty:
    """Return a text that is no JSON."""
    assert right in TEXT
    body = TEXT.replace(right, wrong, 1).encode()
    return Faulty(slip=slip, body=body, code="not_json", told=(*told, "near `"))


EXTRA, KIND, RANGE = "extra_forbidden", "unknown_kind", "out_of_range"

FIELDS = [
    with_fault("name", "/plant/cable_lenght_m", 1, EXTRA, "is no field here", "cable_length_m"),
    with_fault("name", "/plant/dampingratio", 0, EXTRA, "is no field here", "damping_ratio?"),
    with_fault("name", "/actuator/modle", "switched", EXTRA, "is no field here", "mean model"),
    with_fault("name", "/shaper/max_duration_period", 3, EXTRA, "max_duration_periods"),
    with_fault("name", "/sensitivity/tolerence", 0.05, EXTRA, "mean tolerance?"),
    with_fault("name", "/half_widht", 0.1, EXTRA, "mean half_width?", operation="recommendation"),
    with_fault("name", "/x/spacin", "linear", EXTRA, "mean spacing?", operation="map"),
    with_fault("place", "/damping_ratio", 0.1, EXTRA, "mean /plant/damping_ratio?"),
    with_fault("place", "/sample_time_s", 0.01, EXTRA, "mean /shaper/sample_time_s?"),
    with_fault("place", "/plant/dead_time_s", 0.01, EXTRA, "mean /actuator/dead_time_s?"),
    with_fault("unit", "/plant/cable_length_cm", 80, EXTRA, "cable_length_m, 100 times smaller"),
    with_fault("unit", "/plant/cable_length_ft", 3, EXTRA, "cable_length_m, 3.28084 times smaller"),
    with_fault("unit", "/plant/gravity_g", 1, EXTRA, "gravity_m_s2, 9.80665 times larger"),
    with_fault(
        "unit", "/plant/damping_ratio_percent", 1, EXTRA, "damping_ratio, 100 times smaller"
    ),
    with_fault(
        *("unit", "/plant/natural_frequency_rpm", 33, EXTRA),
        "natural_frequency_rad_s, 9.5493 times smaller",
        plant=MODE,
    ),
    with_fault("unit", "/plant/mass_g", 1, EXTRA, "mass_kg, 1000 times smaller", plant=SPRING),
    with_fault(
        "unit", "/speed_km_h", 1, EXTRA, "speed_m_s, 3.6 times smaller", operation="maneuver"
    ),
    with_fault(
        *("unit", "/x/field", "/plant/cable_length_in", "unknown_field", "got 'cable_length_in'"),
        "cable_length_m, 39.3701 times smaller",
        operation="map",
    ),
    with_fault("missing", "/plant/cable_length_m", LEFT_OUT, "missing", "or cable_length_mm"),
    with_fault(
        *("missing", "/plant/natural_frequency_rad_s", LEFT_OUT, "missing", "natural_frequency_hz"),
        "period_s",
        plant=MODE,
    ),
]

CHOICES = [
    with_fault("kind", "/shaper", {"kind": "numzdv"}, KIND, "'numzdv'", "mean numzv, numzvd or"),
    with_fault("kind", "/plant", {"kind": "pendulam"}, KIND, "'pendulam'", "mean pendulum or"),
    with_fault("kind", "/actuator", {"kind": "second-order"}, KIND, "got", "mean second_order?"),
    with_fault("kind", "/shaper", {"kind": "posicast"}, KIND, "the kinds are", "zv"),
    with_fault("kind", "/plant", {}, "no_kind", "must have a kind: mode, modes, pend"),
    with_fault(
        "kind",
        "/command",
        {"kind": "puls"},
        KIND,
        "mean pulse or impulses?",
        operation="simulation",
    ),
    with_fault("choice", "/quantity", "residuel", "not_one_of", "mean residual?", operation="map"),
    with_fault(
        *("choice", "/sign", "positiv", "not_one_of", "got 'positiv'", "mean positive?"),
        operation="recommendation",
    ),
    with_fault("choice", "/actuator/model", "superposition", "not_one_of", "mean superposed?"),
]

NUMBERS = [
    with_fault(
        "number", "/plant/cable_length_m", "0.8", "wrong_type", "a number, got '0.8'; give 0.8"
    ),
    with_fault("number", "/plant/cable_length_m", "0,8", "wrong_type", "got '0,8'; give 0.8, with"),
    with_fault("number", "/plant/gravity_m_s2", " 9,81 ", "wrong_type", "give 9.81, with a point"),
    with_fault("number", "/plant/cable_length_m", None, "wrong_type", "a number, got null"),
    with_fault("number", "/plant/cable_length_m", True, "wrong_type", "a number, got true"),
    with_fault("number", "/sensitivity/points", 2.5, "wrong_type", "a whole number, got 2.5"),
    with_fault("range", "/plant/cable_length_m", -0.8, RANGE, "greater than 0, got -0.8"),
    with_fault("range", "/plant/damping_ratio", 1.5, RANGE, "at most 0.99, got 1.5"),
    with_fault("range", "/sensitivity/points", 1, RANGE, "at least 2, got 1"),
    with_fault("range", "/half_width", 1.2, RANGE, "0 and 0.95", "1.2", operation="recommendation"),
    with_fault(
        *("range", "/plant/cable_length_mm", -800, RANGE, "greater than 0, got -0.8"),
        "read as cable_length_m",
        plant={"kind": "pendulum"},
    ),
]

TWICE = "unit_said_twice"
REPEATED = [
    with_fault("twice", "/plant/cable_length_mm", 800, TWICE, "cable_length_m and cable_length_mm"),
    with_fault(
        *("twice", "/plant/period_s", 1.8, TWICE, "natural_frequency_rad_s and period_s"),
        plant=MODE,
    ),
    with_fault(
        *("twice", "/plant/log_decrement", 0.1, TWICE, "damping_ratio and log_decrement"),
        plant={**MODE, "damping_ratio": 0.01},
    ),
    *(
        Faulty(
            slip="twice",
            body=TEXT.replace(right, f"{right} {right}", 1).encode(),
            code="name_repeated",
            told=("must be given once",),
            pointer=pointer,
        )
        for right, pointer in (
            ('"cable_length_m": 0.8,', "/plant/cable_length_m"),
            ('"kind": "pendulum",', "/plant/kind"),
        )
    ),
]

TEXTS = [
    with_text("comma", ": 0.8,", ": 0,8,", "line 4, column 23: a decimal comma", "as 0.8"),
    with_text("comma", ": 9.81", ": 12,75", "a decimal comma", "as 12.75"),
    with_text("comment", ": 0.8,", ": 0.8, // m", "line 4, column 26: a comment", "TOML has"),
    with_text("comment", ": 0.8,", ": 0.8, # m", "a comment", "TOML has"),
    with_text("bracket", ": 9.81", ": 9.81,", "a comma before a closing bracket", "none there"),
    with_text("bracket", ': "pendulum"', ': ["pendulum",]', "comma before a closing bracket"),
    with_text("quotes", '"pendulum"', "'pendulum'", "line 3, column 11: single", "double quotes"),
    with_text("quotes", '"pendulum"', "\u201cpendulum\u201d", "typographic quotes", "double ones"),
    with_text("quotes", '"cable_length_m"', "cable_length_m", "a name without double quotes"),
    with_text("word", ": 0.8,", ": True,", "a word of Python", "JSON has true"),
    with_text("word", ": 0.8,", ": None,", "a word of Python", "null"),
    with_text("digit", ": 0.8,", ": .05,", "without a digit ahead of its point", "write 0.05"),
    with_text("digit", ": 0.8,", ": -.8,", "without a digit ahead of its point", "write -0.8"),
    with_text("digit", ": 0.8,", ": 1.,", "without a digit after its point", "write 1.0"),
    with_text("digit", ": 0.8,", ": 00.8,", "with a zero ahead", "write 0.8"),
    with_text("digit", ": 0.8,", ": +0.8,", "a plus sign", "write 0.8"),
    with_text("no JSON", "{", "[printer]\n{", "line 1, column 2: a request is JSON, which begins"),
    with_text("no JSON", "{", "; a printer\n{", "line 1, column 1: a request is JSON"),
    with_text("no JSON", "{", "kind = 3 {", "line 1, column 1: a request is JSON"),
    with_text("sign", ": 0.8,", ": 0.8", "line 5, column 3: a comma is missing ahead of this"),
    with_text("sign", '"cable_length_m":', '"cable_length_m"', "a colon is missing ahead of this"),
]

ENCODED = [
    Faulty(
        slip="encoding",
        body=TEXT.encode(encoding),
        code="not_json",
        told=(name, "send UTF-8 without a byte order mark"),
        file_is_read=True,
    )
    for encoding, name in (
        ("utf-8-sig", "UTF-8 with a byte order mark"),
        ("utf-16", "UTF-16"),
        ("utf-16-be", "UTF-16-BE"),
    )
] + [
    Faulty(
        slip="encoding",
        body=TEXT.replace("pendulum", "p\xe9ndulum", 1).encode("latin-1"),
        code="not_json",
        told=("line 3, column 13: byte 0xe9 is no UTF-8", "save the text as UTF-8"),
    )
]

BINARY = [
    Faulty(
        slip="no text",
        body=start + TEXT.encode(),
        code="not_json",
        told=("the file is no text: a request is JSON",),
    )
    for start in (b"\x89PNG\r\n\x1a\n\0\0", b"\xff\xd8\xff\xe0\0\x10JFIF", b"PK\x03\x04\x14\0")
]

LISTS = [
    (
        "d.csv",
        "/plant/cable_length_m;/plant/damping_ratio\n0,6;0.01\n",
        "decimals_mixed",
        "take one",
    ),
    (
        "d.csv",
        "/plant/cable_length_m;/plant/damping_ratio\n0,6;0,01;1\n",
        "cells_unlike_headings",
        "2",
    ),
    ("d.csv", "/plant/cable_length_m\n0.6 m\n", "cell_not_finite", "got '0.6 m'"),
    ("d.csv", "cable_length_m\n0.6\n", "heading_not_pointer", "as /plant/cable_length_m"),
    ("d.jsonl", '{"plant": {"cable_length_m": .6}}\n', "line_not_json", "write 0.6"),
    ("d.jsonl", "[0.6]\n", "line_not_object", "must be a JSON object, got [0.6]"),
    (
        "d.toml",
        "[[designs]]\nplant = {cable_length_m = .6}\n",
        "list_not_toml",
        "line 2, column 27: a number without",
    ),
    ("d.toml", "[designs]\n", "list_without_headings", "a heading [[designs]]"),
]
"""Lists of designs beside a specification: name, text, code, and a part of the answer."""

FAULTY = [*FIELDS, *CHOICES, *NUMBERS, *REPEATED, *TEXTS, *ENCODED, *BINARY]
