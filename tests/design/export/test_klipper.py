"""What Klipper plays for a line is what the row claims, or the line is refused."""

import math
from typing import Any

import numpy as np
import pytest

from design.analysis.certificate import certify_modes
from design.analysis.insensitivity import insensitivity
from design.analysis.residual import residual_vibration
from design.claims import Promise
from design.errors import InfeasibleDesignError, InvalidInputError
from design.export.klipper import EXPORT as KLIPPER
from design.export.klipper import NAMES
from design.export.klipper_shapers import (
    MAX_DAMPING_RATIOS,
    klipper_impulses,
    older_klipper_impulses,
)
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.pipeline import Design, design
from design.shapers.registry import SHAPERS
from design.tables.rows import TableHead, subject_of
from schemas.tables import TableDesign
from tests.designed_tables import designed_table, head_of
from tests.firmware import RefusedError, klipper_reads, line_of_x
from tests.refusals import refused

HERTZ = 40.0


def written(
    shaper: dict[str, Any], damping: float, hertz: float = HERTZ
) -> tuple[TableHead, Design, str]:
    """Return the head of a table of one row, its design, and the file."""
    request = {
        "plant": {
            "kind": "mode",
            "natural_frequency_rad_s": 2 * math.pi * hertz,
            "damping_ratio": damping,
        },
        "actuator": {"kind": "ideal"},
        "shaper": shaper,
    }
    head, rows = designed_table(request, {"plant.damping_ratio": [damping]})
    subject = subject_of(head)
    made = design(subject.plant, subject.actuator, subject.kind, subject.options)
    KLIPPER.checks(head)
    return head, made, b"".join(KLIPPER.write(head, [rows])).decode()


@pytest.mark.parametrize("damping", [0.0, 0.02, 0.1, 0.3])
@pytest.mark.parametrize(
    "shaper",
    [
        {"kind": "zv"},
        {"kind": "zvd"},
        {"kind": "mzv"},
        {"kind": "mzv", "t": 0.6},
        {"kind": "mzv", "tau": 1.2},
        {"kind": "mzv", "n": 5, "t": 1.1},
        {"kind": "mzv", "n": 10, "tau": 0.9},
    ],
)
def test_the_line_makes_klipper_play_the_impulses_of_the_design(
    shaper: dict[str, Any], damping: float
) -> None:
    _, made, text = written(shaper, damping)
    line = line_of_x(text)
    played = klipper_reads(line)
    np.testing.assert_allclose(played.times_s, made.impulses.times_s, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(played.amplitudes, made.impulses.amplitudes, rtol=1e-9)
    plain = len(shaper) == 1
    if plain:
        older = klipper_reads(line, older=True)
        np.testing.assert_allclose(older.times_s, made.impulses.times_s, rtol=1e-9, atol=1e-15)
    else:
        with pytest.raises(RefusedError):
            klipper_reads(line, older=True)


def keeps(made: Design, line: str, damping: float, *, older: bool) -> None:
    """Check the tolerance of the design, over its band, for what the firmware plays.

    Klipper's fits of humps have five digits, and no parameter: they have 1 % of the tolerance.
    """
    tolerance = max(claim.limit for claim in made.certificate.claims)
    digits = 1 + 1e-9 if "ei(v_tol" in line else 1.01
    mode = Mode(natural_frequency_rad_s=2 * math.pi * HERTZ, damping_ratio=damping)
    for claim in made.certificate.claims:
        limit = digits * tolerance
        asked = Promise(quantity=claim.quantity, limit=limit, band=claim.band)
        played = klipper_reads(line, older=older)
        (found,) = certify_modes(played, (mode,), Ideal(), (asked,)).claims
        assert found.value <= limit, (line, claim, found)


@pytest.mark.parametrize("damping", [0.0, 0.01, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("tolerance", [0.01, 0.02, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("kind", ["ei", "two_hump_ei", "three_hump_ei"])
def test_fitted_shapers_keep_their_claims_in_every_klipper_that_reads_the_line_or_are_refused(
    kind: str, tolerance: float, damping: float
) -> None:
    error: InvalidInputError | None = None
    try:
        _, made, text = written({"kind": kind, "tolerance": tolerance}, damping)
    except InfeasibleDesignError:
        assert (kind, tolerance, damping) == ("three_hump_ei", 0.2, 0.2)
        return
    except InvalidInputError as refused:
        error = refused
    if error is not None:
        assert error.name == "impulses of row 0"
        assert str(error.value).endswith(" %")
        assert kind != "ei" or tolerance < 0.02
        return
    line = line_of_x(text)
    keeps(made, line, damping, older=False)
    try:
        keeps(made, line, damping, older=True)
    except RefusedError:
        assert "(" in line
    assert "; Klipper's fit leaves" in text


def test_the_tolerance_asked_for_is_handed_over_not_that_of_klipper() -> None:
    """At 2 % and a damping ratio of 0.1 Klipper's usual ei would leave 5.06 %."""
    _, made, text = written({"kind": "ei", "tolerance": 0.02}, 0.1)
    line = line_of_x(text)
    assert "SHAPER_TYPE_X=ei(v_tol=0.020000)" in line
    keeps(made, line, 0.1, older=False)


@pytest.mark.parametrize("tolerance", [0.0234567891, 1 / 30, 0.0499999996, 0.05 + 1e-9])
def test_a_tolerance_of_many_digits_is_kept_by_the_one_that_is_written(tolerance: float) -> None:
    for damping in (0.0, 0.07):
        _, made, text = written({"kind": "ei", "tolerance": tolerance}, damping)
        line = line_of_x(text)
        keeps(made, line, damping, older=False)


@pytest.mark.parametrize(
    ("kind", "tolerance", "damping", "name"),
    [
        ("two_hump_ei", 0.055, 0.02, "2hump_ei"),
        ("three_hump_ei", 0.055, 0.01, "3hump_ei()"),
    ],
)
def test_humps_go_by_klippers_names(kind: str, tolerance: float, damping: float, name: str) -> None:
    _, _, text = written({"kind": kind, "tolerance": tolerance}, damping)
    assert f"SHAPER_TYPE_X={name} " in text


def test_a_row_whose_impulses_are_not_those_of_the_name_is_refused() -> None:
    request = {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 250.0, "damping_ratio": 0.0},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "zvd"},
    }
    head, rows = designed_table(request, {"plant.natural_frequency_rad_s": [250.0]})
    rows.results[0, 1] *= 1 + 1e-6
    with refused("klipper_computes_others", "impulses of row 0"):
        list(KLIPPER.write(head, [rows]))


@pytest.mark.parametrize(
    ("shaper", "damping"),
    [("ei", 0.45), ("two_hump_ei", 0.31), ("three_hump_ei", 0.21)],
)
def test_a_damping_ratio_that_klipper_refuses_is_refused(shaper: str, damping: float) -> None:
    largest = MAX_DAMPING_RATIOS[NAMES[shaper]]
    with refused(
        "too_damped_for_klipper",
        "damping_ratio of row 0",
        says=rf"at most {largest} for Klipper's .*, got {damping}",
    ):
        written({"kind": shaper, "tolerance": 0.1}, damping)


@pytest.mark.parametrize(("n", "t"), [(6, 2.443), (7, 2.85), (8, 3.4), (9, 3.55), (10, 3.9)])
def test_an_mzv_that_klipper_cannot_solve_is_refused(n: int, t: float) -> None:
    """For each of these Klipper says "Ill-formed shaper", or its heights are off."""
    with refused("klipper_near_singular", "t of row 0"):
        written({"kind": "mzv", "n": n, "t": t}, 0.05)


def test_too_many_impulses_for_klipper_are_refused_before_any_row() -> None:
    with refused("too_many_for_klipper", "shaper.n", says="at most 10 for Klipper, got 12"):
        written({"kind": "mzv", "n": 12, "t": 1.0}, 0.0)


@pytest.mark.parametrize("kind", sorted(set(SHAPERS) - set(NAMES)))
def test_kinds_that_klipper_does_not_compute_are_refused_by_name(kind: str) -> None:
    actuator: dict[str, Any] = {"kind": "ideal"}
    if "ideal" not in SHAPERS[kind].actuators:
        actuator = {
            "kind": "first_order",
            "accel_time_constant_s": 0.1,
            "decel_time_constant_s": 0.1,
        }
    plant = {"kind": "mode", "natural_frequency_rad_s": 9.0, "damping_ratio": 0.0}
    request = {"plant": plant, "actuator": actuator, "shaper": {"kind": kind}}
    subject = TableDesign.model_validate(request).to_design()
    assert subject.kind.name == kind
    head = head_of(request, (), 1, (1.0,))
    with refused("not_klipper_shaper", "shaper.kind", says=rf"one of .*, got '{kind}'"):
        KLIPPER.checks(head)


UNDAMPED = [
    # shaper, times over the period, heights: klippy/extras/shaper_defs.py, the constants of
    # get_2hump_ei_shaper and get_3hump_ei_shaper, get_ei_shaper at v_tol = 0, docs for the rest.
    ("2hump_ei", [0, 0.49890, 0.99748, 1.49920], [0.16054, 0.33911, 0.34089, 0.15997]),
    (
        "3hump_ei",
        [0, 0.49974, 0.99849, 1.49870, 1.99960],
        [0.11275, 0.23698, 0.30008, 0.23775, 0.11244],
    ),
    ("zv", [0, 0.5], [0.5, 0.5]),
    ("zvd", [0, 0.5, 1], [0.25, 0.5, 0.25]),
    ("mzv", [0, 0.375, 0.75], [1 - 2**-0.5, 2**0.5 - 1, 1 - 2**-0.5]),
]


@pytest.mark.parametrize(("shaper", "times", "heights"), UNDAMPED)
def test_undamped_shapers_are_the_constants_that_klipper_prints(
    shaper: str, times: list[float], heights: list[float]
) -> None:
    """34 numbers; heights are divided by their sum (kin_shaper.c, init_shaper)."""
    found = klipper_impulses(shaper, HERTZ, 0.0)
    np.testing.assert_allclose(found.times_s * HERTZ, times, atol=1e-12)
    np.testing.assert_allclose(found.amplitudes, np.array(heights) / sum(heights), atol=1e-12)


def test_ei_is_the_polynomials_that_klipper_prints() -> None:
    """get_ei_shaper: a1, a3 and t2 by hand at z = 0.1, v_tol = 0.02."""
    z, v = 0.1, 0.02
    a1 = 0.24968 + 0.24961 * v + (0.80008 + 1.23328 * v) * z + (0.49599 + 3.17316 * v) * z * z
    a3 = 0.25149 + 0.21474 * v + (-0.83249 + 1.41498 * v) * z + (0.85181 - 4.90094 * v) * z * z
    t2 = (
        0.4999
        + (0.46159 + 8.57843 * v) * v * z
        + (4.26169 - 108.644 * v) * v * z**2
        + (1.75601 + 336.989 * v) * v * z**3
    )
    found = klipper_impulses("ei", HERTZ, z, tolerance=v)
    period = 1 / math.sqrt(1 - z * z)
    np.testing.assert_allclose(found.amplitudes, [a1, 1 - a1 - a3, a3], atol=1e-14)
    np.testing.assert_allclose(found.times_s * HERTZ, [0, t2 * period, period], atol=1e-14)


REACHES = [
    # docs/Resonance_Compensation.md, "Input shapers", table: duration in periods, then percent of
    # shaper_freq within which vibration is at most 5 %, and 10 %; "usually approximate", for
    # damping ratios from 0.075 to 0.15.
    ("zv", 0.5, None, (-5, 5)),
    ("mzv", 0.75, (-4, 4), (-10, 15)),
    ("zvd", 1.0, (-15, 15), (-22, 22)),
    ("ei", 1.0, (-20, 20), (-25, 25)),
    ("2hump_ei", 1.5, (-40, 45), (-45, 50)),
    ("3hump_ei", 2.0, (-50, 60), (-55, 65)),
]


@pytest.mark.parametrize(("shaper", "periods", "at_5", "at_10"), REACHES)
def test_shapers_reach_as_far_as_klipper_documents(
    shaper: str, periods: float, at_5: tuple[int, int] | None, at_10: tuple[int, int]
) -> None:
    """28 numbers, rounded to 5 points of percent; at 5.6 %, where the fit with three humps ends."""
    mode = Mode(natural_frequency_rad_s=2 * math.pi * HERTZ, damping_ratio=0.1)
    played = klipper_impulses(shaper, HERTZ, 0.1)
    assert played.duration_s * HERTZ == pytest.approx(periods, rel=0.02)
    for tolerance, reach in ((0.056, at_5), (0.1, at_10)):
        if reach is not None:
            found = insensitivity(played, mode, Ideal(), tolerance)
            assert found is not None
            ends = 100 * (np.array([found.lower_ratio, found.upper_ratio]) - 1)
            np.testing.assert_allclose(ends, reach, atol=5.5)


def test_older_klipper_decays_undamped_humps_by_each_impulse() -> None:
    """Of Kalico's ei at z = 0.1: 3.55 % are left where 5 % are said."""
    mode = Mode(natural_frequency_rad_s=2 * math.pi * HERTZ, damping_ratio=0.1)
    left = residual_vibration(older_klipper_impulses("ei", HERTZ, 0.1), mode, Ideal())
    assert left == pytest.approx(0.0355, abs=5e-5)


@pytest.mark.parametrize("kind", ["two_hump_ei", "three_hump_ei"])
def test_a_claim_that_klippers_fit_does_not_keep_is_refused_with_what_it_is(kind: str) -> None:
    with refused(
        "klipper_breaks_claim", "impulses of row 0", says=r"at most 1 %.*, got '[45]\.\d+ %'$"
    ):
        written({"kind": kind, "tolerance": 0.01}, 0.1)


def test_impulses_that_are_not_those_in_continuous_time_are_not_fitted() -> None:
    request = {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 250.0, "damping_ratio": 0.0},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "ei"},
    }
    head, rows = designed_table(request, {"plant.natural_frequency_rad_s": [250.0]})
    assert list(KLIPPER.write(head, [rows]))
    rows.results[0, 1] *= 1 + 1e-6
    with refused("not_continuous_time", "impulses of row 0"):
        list(KLIPPER.write(head, [rows]))
