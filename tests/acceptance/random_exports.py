"""Random designs as files of every format, read back by the rules of each reader.

    python -m tests.acceptance.random_exports 2000

writes as many files of cases of `tests.random_cases`, in all formats by turns, and reads each back:
its impulses are those of the design, or the format refuses it by name. Then digits and signs of
numbers in files that were read back are changed, one a file, and the same comparison has to find
each. Prints counts and refusals by reason, and exits 1 if anything is wrong. ``--first n`` begins
at another case. The suite runs the first of them.
"""

import argparse
import io
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from design.analysis.certificate import certify_modes
from design.claims import Promise
from design.errors import DesignError, InvalidInputError
from design.export.klipper import NAMES
from design.export.registry import EXPORTS
from design.export.single import single_table
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.pipeline import Design, design
from design.shapers.ei import ToleranceOptions
from design.shapers.registry import SHAPERS
from design.tables.rows import VERIFIED, VERIFIED_IDEAL, Subject
from tests.firmware import RefusedError, lines_of, m593_numbers
from tests.random_cases import Case, case, random_options
from tests.readers import Held, UnreadableError, read_back

FORMATS = (
    "c",
    "st",
    "klipper",
    "rrf",
    "csv",
    "json",
    "parquet",
    "mat",
    "marlin",
    "plcopen",
    "twincat",
    "scl",
    "arduino",
)
PROGRAMS = ("c", "st", "plcopen", "twincat", "scl", "arduino")
KNOWN_SHARE = 0.8
"""Of Klipper's and Marlin's cases, those whose kind and drive they know: else they are few [-]."""

MARLIN_CLOSE = 1e-6
"""Of numbers of seven digits, as a share [-]."""

HEIGHT_OF_MARLIN = 2 / 128
"""Of heights: its cubic is off by less than a 128th, and is rounded down to one [-]."""

LINES_CLOSE = 5.1e-10
"""Half of the ninth decimal, in lines for RepRapFirmware."""

OLDER = re.compile(r"^; 3.4 to 3.5: (.*)$", re.MULTILINE)

KLIPPERS_DIGITS = 1.01
"""What Klipper's fits of humps may leave over a tolerance [-]."""

KLIPPER_CLOSE = 1e-8
"""Of impulses that Klipper computes: a tenth of what any digit does that is changed here [-]."""

MUTATIONS = 50
BINARY = ("mat", "parquet", "twincat", "arduino")
MUTABLE = (
    "c",
    "st",
    "klipper",
    "rrf",
    "csv",
    "json",
    "mat",
    "parquet",
    "marlin",
    "plcopen",
    "twincat",
    "scl",
    "arduino",
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Written:
    """A file and what it is of."""

    name: str
    text: bytes
    subject: Subject
    made: Design


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verdict:
    """What became of a case: what is wrong, or why it was refused, or a file."""

    number: int
    name: str
    wrong: str = ""
    refused: str = ""
    written: Written | None = None


def exported_case(number: int) -> tuple[Case, str]:
    """Return a case and the format it is written in; Klipper's and Marlin's are mostly known."""
    subject, name = case(number), FORMATS[number % len(FORMATS)]
    rng = np.random.default_rng([7, number])
    known = {"klipper": list(NAMES), "marlin": ["zv"]}.get(name)
    if known is not None and rng.random() < KNOWN_SHARE:
        kind = SHAPERS[str(rng.choice(known))]
        options, _ = random_options(rng, kind.options)
        plant = case(number).plant
        if len(plant.modes) == 1:
            return replace(subject, kind=kind, actuator=Ideal(), options=options), name
    return subject, name


def verdict(number: int, folder: Path) -> Verdict:
    """Design a case, write it, read it back."""
    one, name = exported_case(number)
    try:
        made = design(one.plant, one.actuator, one.kind, one.options)
    except DesignError as error:
        return Verdict(number=number, name=name, refused=f"no design: {type(error).__name__}")
    options = one.kind.options() if one.options is None else one.options
    subject = Subject(plant=one.plant, actuator=one.actuator, kind=one.kind, options=options)
    head, rows = single_table(made, subject, request_json=f'{{"case":{number}}}', version="0")
    try:
        EXPORTS[name].checks(head)
        text = b"".join(EXPORTS[name].write(head, [rows]))
    except InvalidInputError as error:
        return Verdict(number=number, name=name, refused=f"{name}: {error}")
    written = Written(name=name, text=text, subject=subject, made=made)
    wrong = difference(written, text, folder)
    return Verdict(number=number, name=name, wrong=wrong, written=written)


def difference(written: Written, text: bytes, folder: Path) -> str:
    """Return in what a file that was read back differs from the design; empty if in nothing."""
    try:
        held = read_back(written.name, text, folder)
    except (RefusedError, UnreadableError, InvalidInputError) as error:
        return f"unreadable: {error}"
    if len(held) != 1:
        return f"{len(held)} rows"
    if written.name == "klipper":
        return "".join(_difference_in_klipper(written, played) for played in held[0].impulses)
    if written.name == "marlin":
        return _difference_in_marlin(written, held[0])
    if written.name == "rrf":
        return _difference_in_lines(written, text.decode(), held[0])
    return _difference_in_numbers(written, held[0])


def _difference_in_numbers(written: Written, held: Held) -> str:
    """Compare bit for bit."""
    made = written.made
    if held.status != (VERIFIED_IDEAL if made.for_ideal else VERIFIED):
        return f"status {held.status}"
    (found,) = held.impulses
    numbers = [*made.impulses.times_s, *made.impulses.amplitudes]
    if [*found.times_s, *found.amplitudes] != numbers:
        return f"impulses {found.times_s.tolist()}, {found.amplitudes.tolist()}, not {numbers}"
    if written.name in PROGRAMS:
        numbers = []  # they stand once
    numbers.append(made.residual)
    return "" if list(held.numbers) == numbers else f"columns {held.numbers}, not {numbers}"


def _difference_in_lines(written: Written, text: str, held: Held) -> str:
    """Compare the impulses of both lines, and each number of either to its last digit."""
    shaper = written.made.impulses
    times, heights = shaper.times_s - shaper.times_s[0], shaper.amplitudes
    for found in held.impulses:
        late = np.abs(found.times_s - times).max() if found.times_s.size == times.size else np.inf
        if late > times.size * LINES_CLOSE:
            return f"times {found.times_s.tolist()}, not {times.tolist()}"
    (newer,), (older,) = lines_of(text), OLDER.findall(text)
    for line, wanted in (
        (newer, (heights[:-1], times[1:])),
        (older, (np.cumsum(heights[:-1]), np.diff(times))),
    ):
        for got, numbers in zip(m593_numbers(line), wanted, strict=True):
            if len(got) != numbers.size or np.abs(np.array(got) - numbers).max() > LINES_CLOSE:
                return f"{got}, not {numbers.tolist()}"
    return ""


def _difference_in_klipper(written: Written, played: Impulses) -> str:
    made, subject = written.made, written.subject
    if not isinstance(subject.options, ToleranceOptions):
        wanted = made.impulses
        if played.times_s.size != wanted.times_s.size:
            return "number of impulses"
        late = np.abs(played.times_s - wanted.times_s).max() / wanted.duration_s
        high = np.abs(played.amplitudes - wanted.amplitudes).max()
        return "" if max(late, high) <= KLIPPER_CLOSE else f"apart by {late:.3g}, {high:.3g}"
    # A tolerance, over its band; fits of five digits without a parameter have 1 % of it.
    digits = 1.0 if written.subject.kind.name == "ei" else KLIPPERS_DIGITS
    limit = digits * max(claim.limit for claim in made.certificate.claims)
    promises = tuple(
        Promise(quantity=claim.quantity, limit=limit, mode=claim.mode, band=claim.band)
        for claim in made.certificate.claims
    )
    broken = [
        claim
        for claim in certify_modes(played, subject.plant.modes, Ideal(), promises).claims
        if not claim.holds
    ]
    return "".join(f"{claim.quantity} {claim.value:.4g} > {claim.limit:.4g}" for claim in broken)


def _difference_in_marlin(written: Written, held: Held) -> str:
    """Compare numbers with those of the mode, and impulses with those of the design."""
    shaper, (mode,) = written.made.impulses, written.subject.plant.modes
    damped_hz = mode.natural_frequency_rad_s * np.sqrt(1 - mode.damping_ratio**2) / (2 * np.pi)
    wanted = [damped_hz, mode.damping_ratio] * 2
    if not np.allclose(held.numbers, wanted, rtol=MARLIN_CLOSE, atol=0):
        return f"{held.numbers}, not {wanted}"
    for found in held.impulses:
        late = np.abs(found.times_s - shaper.times_s).max() / shaper.duration_s
        high = np.abs(found.amplitudes - shaper.amplitudes).max()
        if late > MARLIN_CLOSE or high > HEIGHT_OF_MARLIN:
            return f"apart by {late:.3g}, {high:.3g}"
    return ""


PLAIN = r"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"

PLACES = {
    "c": (
        r"(?s)/\* A row without a design.*?/\* A shaper for a live",
        rf"SHAPERSMITH_C\(({PLAIN})\)",
    ),
    "plcopen": (r"(?s)<arrayValue>.*?</arrayValue>", rf'value="({PLAIN})"'),
    "scl": (r"(?s):= \[.*?\];", rf"(?<![\w.])({PLAIN})(?=[,\]\s])"),
    "st": (r"(?s):= \[.*?\];", rf"(?<![\w.])({PLAIN})(?=[,\]\s])"),
    "klipper": (r"(?m)^SET_INPUT_SHAPER.*$", rf"=({PLAIN})(?=[ ,)]|$)"),
    "rrf": (r"(?m)^(?:M593|; 3.4 to 3.5: M593).*$", rf"[HT:]({PLAIN})(?=[: ]|$)"),
    "marlin": (r"(?m)^M593.*$", rf"[FD]({PLAIN})(?= |$)"),
    "csv": (r"(?m)^-?\d.*$", rf"(?:^|,)({PLAIN})(?=,|$)"),
    "json": (r"(?m)^\[.*$", rf"[\[ ]({PLAIN})(?=,)"),
}
"""Where numbers stand that make the reader do what it does, and what such a number is."""


def _spans(written: Written) -> list[tuple[int, int]]:
    text = written.text.decode()
    part, number = PLACES[written.name]
    return [
        (place.start() + match.start(1), place.start() + match.end(1))
        for place in re.finditer(part, text)
        for match in re.finditer(number, place[0])
    ]


def mutate(written: Written, rng: np.random.Generator) -> bytes:
    """Return the file with one digit or one sign of one number changed to another value."""
    if written.name in BINARY:
        return _mutate_binary(written, rng)
    text = written.text.decode()
    spans = _spans(written)
    while True:
        first, last = spans[int(rng.integers(len(spans)))]
        number = text[first:last]
        if rng.random() < 0.2:
            changed = number[1:] if number.startswith("-") else f"-{number}"
        else:
            mantissa = re.split("[eE]", number)[0]
            digits = [index for index, letter in enumerate(mantissa) if letter.isdigit()]
            at = digits[int(rng.integers(min(len(digits), 8)))]
            digit = str((int(number[at]) + int(rng.integers(1, 10))) % 10)
            changed = number[:at] + digit + number[at + 1 :]
        if float(changed) != float(number):
            return (text[:first] + changed + text[last:]).encode()


def _mutate_binary(written: Written, rng: np.random.Generator) -> bytes:
    """Change a number of a file that is no text: in its bytes, or packed anew."""
    numbers = [*written.made.impulses.times_s[1:], *written.made.impulses.amplitudes]
    value = float(numbers[int(rng.integers(len(numbers)))])
    if written.name in {"twincat", "arduino"}:
        at = written.text.index(b"_times") + int(rng.integers(40))  # its sum is wrong then
        return written.text[:at] + bytes([written.text[at] ^ 1]) + written.text[at + 1 :]
    if written.name == "mat":
        packed = np.array(value, dtype="<f8").tobytes()
        at = written.text.index(packed) + int(rng.integers(len(packed)))
        flipped = written.text[at] ^ (1 << int(rng.integers(8)))
        return written.text[:at] + bytes([flipped]) + written.text[at + 1 :]
    table = parquet.read_table(io.BytesIO(written.text))
    names = [name for name in table.column_names if name not in {"status", "reason"}]
    name = names[int(rng.integers(len(names)))]
    held = table.column(name).to_numpy() * (1 + 10.0 ** -int(rng.integers(1, 12))) + 1e-300
    place = table.column_names.index(name)
    table = table.set_column(place, table.schema.field(place), pa.array(held))
    sink = io.BytesIO()
    parquet.write_table(table, sink)
    return sink.getvalue()


def miss(written: list[Written], count: int, folder: Path) -> Iterator[str]:
    """Change files, one number each, and yield those where the comparison finds nothing."""
    by_name = {name: [one for one in written if one.name == name] for name in MUTABLE}
    present = [name for name in MUTABLE if by_name[name]]
    for number in range(count):
        rng = np.random.default_rng([11, number])
        name = present[number % len(present)]
        one = by_name[name][number // len(present) % len(by_name[name])]
        if not difference(one, mutate(one, rng), folder):
            yield f"mutation {number} of {name} was not found"


def reason(refused: str) -> str:
    """Return a refusal without its numbers."""
    return re.sub(r"-?\d+(\.\d+)?(e[+-]?\d+)?", "#", refused)[:100]


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found = []
        for number in range(given.first, given.first + given.count):
            found.append(verdict(number, folder))
            if found[-1].wrong:
                print(f"WRONG: case {number}: {found[-1].wrong[:300]}", file=sys.stderr, flush=True)
        written = [one.written for one in found if one.written is not None and not one.wrong]
        lost = list(miss(written, MUTATIONS, folder))
    counts = {
        "read back": Counter(one.name for one in written),
        "wrong": Counter(one.name for one in found if one.wrong),
        "refused": Counter(one.name for one in found if one.refused),
    }
    print("format      " + " ".join(f"{key:>10}" for key in counts))
    for name in FORMATS:
        print(f"{name:12}" + " ".join(f"{counts[key][name]:10}" for key in counts))
    for text, count in Counter(reason(one.refused) for one in found if one.refused).most_common():
        print(f"{count:6} {text}")
    print(f"changed numbers found: {MUTATIONS - len(lost)} of {MUTATIONS}")
    print("\n".join(lost))
    return int(bool(lost) or any(one.wrong for one in found))


if __name__ == "__main__":
    sys.exit(main())
