"""What people read has hertz, periods and per cent, says what its columns are, and what to run."""

import csv
import io
import itertools
import json
import math
import re
import shlex
from typing import Any

import pytest

import shapersmith as package
from service.cli.plant_lines import DRIVES
from tests.conftest import CRANE
from tests.integration_route import residual_by_integration
from tests.service.cli.commands import shapersmith
from tests.shaper_table import CRANE as CRANE_PLANT
from tests.shapersmith.requests import REQUESTS

DRIVEN = {"plant": CRANE["plant"], "actuator": CRANE["actuator"]}
IDEAL = {"kind": "ideal"}
SPRING = {"kind": "spring_mass", "mass_kg": 2, "stiffness_n_m": 50, "damping_ratio": 0.05}
TWO = {
    "kind": "modes",
    "modes": [{"natural_frequency_hz": 1}, {"period_s": 0.4, "damping_ratio": 0.02}],
}
RANGE = {
    "kind": "scheduled", "plant": CRANE["plant"], "over": "cable_length_m", "from": 0.7, "to": 0.9,
}  # fmt: skip

COMMANDS = {"simulation": "simulate", "recommendation": "recommend"}
"""Commands that are not called as their operation."""


def text(command: str, request: dict[str, Any]) -> str:
    done = shapersmith(command, "-", "--format", "table", given=request)
    assert done.returncode == 0, done.stderr
    return done.stdout


def crane_hertz() -> float:
    return math.sqrt(9.81 / 0.8) / math.tau


@pytest.mark.parametrize("operation", ["design", "sensitivity", "maneuver", "simulation"])
def test_a_text_says_length_hertz_and_period_of_the_plant(operation: str) -> None:
    told = text(COMMANDS.get(operation, operation), REQUESTS[operation])
    hertz = crane_hertz()
    assert (
        f"\nplant       pendulum, cable 0.8 m, {hertz:.5g} Hz, period {1 / hertz:.5g} s\n" in told
    )


@pytest.mark.parametrize(
    ("plant", "kind", "lines"),
    [
        pytest.param(
            SPRING,
            "zv",
            [
                "plant       spring_mass, 2 kg, 50 N/m, 0.79577 Hz, period 1.2566 s, "
                "damping ratio 0.05"
            ],
            id="spring",
        ),
        pytest.param(
            TWO,
            "multi_zv",
            [
                "mode 1      1 Hz, period 1 s",
                "mode 2      2.5 Hz, period 0.4 s, damping ratio 0.02",
            ],
            id="modes",
        ),
        pytest.param(
            RANGE,
            "ei",
            [
                "plant       pendulum, cable_length_m from 0.7 to 0.9, 0.52545 to 0.59581 Hz, "
                "period 1.6784 to 1.9031 s"
            ],
            id="range",
        ),
    ],
)
def test_each_mode_and_both_ends_of_a_range_are_said(
    plant: dict[str, Any], kind: str, lines: list[str]
) -> None:
    told = text("design", {"plant": plant, "actuator": IDEAL, "shaper": {"kind": kind}})
    assert "\n" + "\n".join(lines) + "\n" in told


def test_the_insensitive_band_is_in_hertz_too() -> None:
    told = text("design", CRANE)
    found = re.search(r"insensitive (\S+) to (\S+) of the frequency \((\S+) to (\S+) Hz\)", told)
    assert found is not None
    low, high, low_hertz, high_hertz = map(float, found.groups())
    assert low_hertz == pytest.approx(crane_hertz() * low, rel=1e-4)
    assert high_hertz == pytest.approx(crane_hertz() * high, rel=1e-4)


def test_python_and_notebooks_have_the_same_lines() -> None:
    found = package.design(**CRANE)
    assert str(found) == text("design", CRANE).rstrip()
    assert "cable 0.8 m, 0.55733 Hz" in found._repr_html_()


@pytest.mark.parametrize("limited", [False, True])
def test_a_recommendation_has_a_legend_of_its_columns(limited: bool) -> None:
    drive = {"kind": "rate_limited", "accel_limit_m_s2": 2, "decel_limit_m_s2": 3, "speed_m_s": 0.5}
    told = text("recommend", {**DRIVEN, **({"actuator": drive} if limited else {})})
    rank, shaper, *columns = told.splitlines()[0].split()
    assert (rank, shaper) == ("rank", "shaper")
    assert ("ramp_end_s" in columns) == limited
    assert re.findall(r"^legend      (\S+)", told, re.MULTILINE) == columns


def test_a_recommendation_is_in_per_cent_and_hertz() -> None:
    request = {**DRIVEN, "lower_ratio": 0.9, "upper_ratio": 1.2}
    told = text("recommend", request)
    row = dict(zip(told.splitlines()[0].split(), told.splitlines()[1].split(), strict=False))
    best = json.loads(shapersmith("recommend", "-", given=request).stdout)["recommended"]
    assert float(row["residual_%"]) == pytest.approx(100 * best["worst_residual"], rel=1e-3)
    for end in ("lower", "upper"):
        hertz = float(row["from_hz" if end == "lower" else "to_hz"])
        ratio = best["insensitivity"][f"{end}_ratio"]
        assert hertz == pytest.approx(crane_hertz() * ratio, rel=1e-3)
    plain = shapersmith("recommend", "-", "--format", "csv", given=request).stdout
    first = next(csv.DictReader(io.StringIO(plain)))
    assert float(first["worst_residual"]) == best["worst_residual"]


@pytest.mark.parametrize(
    "request_",
    [
        pytest.param({**DRIVEN, "half_width": 0.1}, id="as-given"),
        pytest.param({**DRIVEN, "lower_ratio": 0.9, "upper_ratio": 1.3}, id="other-middle"),
        pytest.param({"plant": RANGE, "actuator": IDEAL}, id="range"),
        pytest.param({"plant": TWO, "actuator": IDEAL}, id="modes"),
        pytest.param(
            {"plant": SPRING, "actuator": IDEAL, "damping": {"from": 0, "to": 0.06}}, id="damping"
        ),
        pytest.param({**DRIVEN, "sample_time_s": 0.02, "sign": "positive"}, id="samples"),
    ],
)
def test_the_last_line_designs_the_recommended_shaper(request_: dict[str, Any]) -> None:
    last = text("recommend", request_).splitlines()[-1]
    word, echo, body, pipe, program, *arguments = shlex.split(last)
    assert (word, echo, pipe, program) == ("next", "echo", "|", "shapersmith")
    designed = json.loads(shapersmith(*arguments[:2], given=body).stdout)
    best = json.loads(shapersmith("recommend", "-", given=request_).stdout)["recommended"]
    for name, values in best["impulses"].items():
        assert designed["shaper"]["impulses"][name] == pytest.approx(values, abs=1e-9)
    assert shapersmith(*arguments, given=body).returncode == 0


def test_a_certificate_says_of_which_mode_and_band_each_claim_is() -> None:
    request = {"plant": TWO, "actuator": IDEAL, "shaper": {"kind": "multi_zv"}}
    told = re.findall(r"(?m)^certificate .*$", text("design", request))[0]
    assert "residual " in told
    assert "residual of mode 2 " in told
    request = {"plant": CRANE["plant"], "actuator": IDEAL, "shaper": {"kind": "si"}}
    assert "certificate verified: band 0.85 to 1.15: 0.05 <= 0.05\n" in text("design", request)


def worst_corner_by_integration(command: package.Impulses, actuator: dict[str, Any]) -> float:
    """Return the largest residual of the crane's drive off by a tenth, in per cent [%]."""
    drive = actuator.get("then", actuator)
    mode = CRANE_PLANT.mode
    steps = command.to_design()
    residuals = []
    for factors in itertools.product((0.9, 1.1), repeat=4):
        sets = {}
        for name, w, z in (("accel", *factors[:2]), ("decel", *factors[2:])):
            given = drive[name]
            sets[name] = {
                "natural_frequency_rad_s": w * given["natural_frequency_rad_s"],
                "damping_ratio": z * given["damping_ratio"],
            }
        off = {**drive, **sets}
        whole = {**actuator, "then": off} if "then" in actuator else off
        record = DRIVES.validate_python(whole).to_design()
        residuals.append(residual_by_integration(steps, mode, record))
    return 100 * max(residuals)


@pytest.mark.parametrize("limited", [False, True], ids=["switched", "behind limits"])
def test_the_text_of_a_design_says_what_a_drive_that_is_off_leaves(limited: bool) -> None:
    drive: dict[str, Any] = {**CRANE["actuator"], "model": "switched"}
    off = "by 10 %"
    if limited:
        drive = {
            "kind": "rate_limited", "accel_limit_m_s2": 1.6, "decel_limit_m_s2": 2.5,
            "speed_m_s": 0.2, "then": drive,
        }  # fmt: skip
        off += " behind its limits"
    request = {**CRANE, "actuator": drive, "shaper": {"kind": "numzv"}}
    (line,) = (one for one in text("design", request).splitlines() if one.startswith("drive off"))
    head, figure = line.split(" % at worst (")[0].rsplit(" ", 1)
    assert head == f"drive off   {off}:"
    impulses = package.design(**request).shaper.impulses
    worst = worst_corner_by_integration(
        package.Impulses(times_s=impulses.times_s, amplitudes=impulses.amplitudes), drive
    )
    assert float(figure) == pytest.approx(worst, rel=0.005)  # three digits


def test_the_text_says_it_for_the_share_that_is_asked_and_where_it_changes_nothing() -> None:
    told = text("design", {**CRANE, "drive": {"to": 0.2}})
    assert "drive off   by 20 %: " in told
    told = text("design", {**CRANE, "shaper": {"kind": "zvd"}})
    assert "drive off   by 10 %: no more residual\n" in told
    assert "drive off" not in text("design", {**CRANE, "actuator": IDEAL})
    impulses = {"times_s": [0, 0.2, 0.5], "amplitudes": [1, -1, 1]}
    told = text("sensitivity", {**DRIVEN, "impulses": impulses, "drive": {"to": 0.3}})
    assert "drive off   by 30 %: " in told


def test_a_recommendation_for_a_drive_that_is_off_has_a_column_and_a_reason_for_it() -> None:
    first_order = {
        "kind": "first_order", "accel_time_constant_s": 0.03, "decel_time_constant_s": 0.012,
    }  # fmt: skip
    request = {"plant": CRANE["plant"], "actuator": first_order, "half_width": 0.05}
    told = text("recommend", {**request, "drive_off_by": 0.2})
    best = package.recommend(**request, drive_off_by=0.2).recommended
    (verdict,) = (one for one in best.requirements if one.requirement == "drive_off_by")
    heading, row = (line.split() for line in told.splitlines()[:2])
    assert verdict.value is not None
    assert row[heading.index("drive_off_%")] == f"{100 * verdict.value:.4g}"
    assert f"why         {best.name} {verdict.reason}" in told
    assert "drive_off" not in text("recommend", request)
