"""The table of docs/live.md: the same presses through delay lines, live, and as they are."""

import re

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.live.machine import LiveKind, LiveMachine
from design.live.session import Press, event, init
from design.model.commands import convolve, pulse
from design.model.impulses import Impulses
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.design.live.machines import CRANE, KIM
from tests.pages.reading import ROOT

PRESSES_S = np.random.default_rng(1).uniform(0.05, 2.5, 40).tolist()


def row_of(name: str) -> list[float]:
    """Return the figures of a row, without their units."""
    text = (ROOT / "docs" / "live.md").read_text(encoding="utf-8")
    (line,) = [one for one in text.splitlines() if one.startswith(f"| {name} |")]
    return [float(one) for one in re.findall(r"\| ([\d.]+)", line)]


def found_of(residuals: list[float], lasting_s: list[float], beyond: float) -> list[float]:
    """Return figures as those of a row."""
    shares = [100 * float(np.quantile(residuals, one)) for one in (0.5, 0.95, 1.0)]
    return [*shares, float(np.median(lasting_s)), max(lasting_s), 100 * beyond]


@pytest.mark.parametrize("kind", [None, "zv", "umzv", "numzv", "numzvd"])
def test_what_delay_lines_leave(kind: str | None) -> None:
    commands: list[Impulses] = [pulse(press_s) for press_s in PRESSES_S]
    name = "nothing"
    if kind is not None:
        name, entry = f"delay line, `{kind}`", SHAPERS[kind]
        shaper = design(CRANE, KIM, entry, entry.options()).impulses
        commands = [convolve(one, shaper) for one in commands]
    levels = [one.amplitudes.cumsum() for one in commands]
    beyond = float(np.mean([one.max() > 1 + 1e-9 or one.min() < -1e-9 for one in levels]))
    residuals = [residual_vibration(one, CRANE.mode, KIM) for one in commands]
    ends = zip(commands, PRESSES_S, strict=True)
    lasting = [float(one.times_s[-1]) - press_s for one, press_s in ends]
    assert found_of(residuals, lasting, beyond) == pytest.approx(row_of(name), rel=0.02, abs=6e-4)


@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_live_mode_leaves_nothing(kind: str) -> None:
    machine = LiveMachine(plant=CRANE, actuator=KIM, kind=LiveKind(name=kind))
    pressed = event(machine, init(machine), 0.0, Press(x=1.0))
    released = [event(machine, pressed, press_s, Press(x=0.0)) for press_s in PRESSES_S]
    left, lasting = [], []
    for press_s, state in zip(PRESSES_S, released, strict=True):
        assert state.certificate is not None
        left.append(max(claim.value for claim in state.certificate.claims))
        lasting.append(state.last_switch_s - press_s)
    assert max(left) < 1e-11
    assert found_of(left, lasting, 0.0) == pytest.approx(row_of(f"live, `{kind}`"), abs=6e-4)
