"""Constructors in closed form beside a textbook's lines; shapers for two modes and over a band."""

import functools
import math
import time
from collections.abc import Callable, Iterator
from statistics import median

import numpy as np

from benchmarks.designs import ACTUATOR
from benchmarks.measure import Figure, alternating_medians, ratio
from design.formulations.formulation import ClosedForm
from design.formulations.humps import follow_from_undamped
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers import numsi
from design.shapers.ei import ToleranceOptions
from design.shapers.registry import SHAPERS
from design.types import FloatArray

MAX_CLOSED_FORM_S = 50e-6
DAMPED = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.05)
UNDAMPED = Mode(natural_frequency_rad_s=3.5)

CLOSED_FORMS: tuple[tuple[str, Mode, Actuator], ...] = (
    ("zv", DAMPED, Ideal()),
    ("zvd", DAMPED, Ideal()),
    ("zvdd", DAMPED, Ideal()),
    ("zvddd", DAMPED, Ideal()),
    ("mzv", DAMPED, Ideal()),
    ("ei", UNDAMPED, Ideal()),
    ("umzv", UNDAMPED, Ideal()),
    ("umzvc", UNDAMPED, FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)),
    ("numzv", UNDAMPED, ACTUATOR),
    ("um_ei", DAMPED, Ideal()),
)
"""Kind, mode, actuator. `ei` and `um_ei` keep what they have solved: these find it again."""


def textbook_zvd(w: float, z: float) -> tuple[FloatArray, FloatArray]:
    """Return times and amplitudes of a ZVD shaper, as a page of a textbook has it."""
    k = np.exp(-z * np.pi / np.sqrt(1 - z**2))
    half = np.pi / (w * np.sqrt(1 - z**2))
    return np.array([0, half, 2 * half]), np.array([1, 2 * k, k**2]) / (1 + k) ** 2


def textbook_ei(w: float, z: float, v: float = 0.05) -> tuple[FloatArray, FloatArray]:
    """Return the same of an EI shaper by the undamped form scaled by powers of K: 3.55 % at .1."""
    k = np.exp(-z * np.pi / np.sqrt(1 - z**2))
    half = np.pi / (w * np.sqrt(1 - z**2))
    amplitudes = np.array([(1 + v) / 4, (1 - v) / 2 * k, (1 + v) / 4 * k**2])
    return np.array([0, half, 2 * half]), amplitudes / amplitudes.sum()


def constructor(name: str, mode: Mode, actuator: Actuator) -> Callable[[], FloatArray]:
    """Return what goes from a mode to impulses, options included."""
    kind = SHAPERS[name]

    def run() -> FloatArray:
        found = kind.formulate(kind.case((mode,), actuator))
        if not isinstance(found, ClosedForm):
            raise TypeError(f"{name} is no closed form here")
        return found.impulses.times_s

    return run


def processor_ms(run: Callable[[], object], repeats: int = 1) -> float:
    """Return the least processor time of a few calls [ms]."""
    best = math.inf
    for _ in range(repeats):
        started = time.process_time()
        run()
        best = min(best, time.process_time() - started)
    return 1e3 * best


def closed_forms() -> Iterator[Figure]:
    """Constructors, all in turns with the textbook's."""
    cases = {name: constructor(name, mode, drive) for name, mode, drive in CLOSED_FORMS}
    peers = {
        "textbook ZVD": functools.partial(textbook_zvd, 3.5, 0.05),
        "textbook EI": functools.partial(textbook_ei, 3.5, 0.05),
    }
    seconds = alternating_medians({**cases, **peers}, rounds=15, calls=200, clock=time.process_time)
    took = {name: median(values) for name, values in seconds.items()}
    slowest = max(cases, key=lambda name: took[name])
    each = ", ".join(f"`{name}` {1e6 * took[name]:.0f}" for name in cases)
    lines = ", ".join(f"{name[9:]} {1e6 * took[name]:.0f}" for name in peers)
    yield Figure(
        what="shapers in closed form, mode to impulses / a textbook's NumPy lines for ZVD",
        value=f"{each} us; {lines} us; `zvd` {ratio(seconds, 'zvd', 'textbook ZVD'):.1f} times",
        limit="50 us each",
        met=took[slowest] <= MAX_CLOSED_FORM_S,
    )
    cold, um_ei = [], SHAPERS["um_ei"]
    for number in range(60):
        follow_from_undamped.cache_clear()
        mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.2 * (number + 1) / 60)
        case = um_ei.case((mode,), Ideal(), ToleranceOptions(tolerance=0.05))
        run = functools.partial(um_ei.formulate, case)
        cold.append(processor_ms(run))
    yield Figure(
        what="`um_ei` of a damping ratio not solved before, z to 0.2, median",
        value=f"{median(cold):.2f} ms",
        limit="",
        met=None,
    )


def several_modes() -> Iterator[Figure]:
    """Unity magnitude for two modes at once."""
    rng = np.random.default_rng(1)
    times, gaps = [], []
    for _ in range(40):
        dampings = rng.uniform(0, 0.1, 2)
        pair = Modes(
            modes=(
                Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=float(dampings[0])),
                Mode(
                    natural_frequency_rad_s=2 * math.pi * float(rng.uniform(1.1, 6)),
                    damping_ratio=float(dampings[1]),
                ),
            )
        )
        run = functools.partial(design, pair, Ideal(), SHAPERS["multi_umzv"])
        times.append(processor_ms(run, repeats=2))
        gaps.append(run().solver.gap or 0.0)
    middle, late = np.percentile(times, [50, 95])
    yield Figure(
        what="`multi_umzv` of 40 random pairs, bound and certificate: median, 95 %",
        value=f"{middle:.0f}, {late:.0f} ms, largest gap {max(gaps):.1e}",
        limit="<= 60 ms median",
        met=bool(middle <= 60),
    )


def several_modes_behind_a_drive() -> Iterator[Figure]:
    """Measure steps for two modes behind the thesis's actuator."""
    models: tuple[Model, ...] = ("superposed", "switched")
    for model in models:
        drive = SecondOrder(accel=ACTUATOR.accel, decel=ACTUATOR.decel, model=model)
        rng = np.random.default_rng(3)
        times = []
        for _ in range(40):
            slow, ratio_of_two = float(rng.uniform(1, 5)), float(rng.uniform(1.15, 3.5))
            dampings = rng.uniform(0, 0.1, 2).tolist()
            pair = Modes(
                modes=(
                    Mode(natural_frequency_rad_s=slow, damping_ratio=dampings[0]),
                    Mode(natural_frequency_rad_s=slow * ratio_of_two, damping_ratio=dampings[1]),
                )
            )
            run = functools.partial(design, pair, drive, SHAPERS["num_multi"])
            times.append(processor_ms(run, repeats=2))
        middle, late = np.percentile(times, [50, 95])
        yield Figure(
            what=f"`num_multi` of 40 random pairs, {model}, certificate: median, 95 %",
            value=f"{middle:.0f}, {late:.0f} ms",
            limit="<= 100 ms median",
            met=bool(middle <= 100),
        )


def over_a_band() -> Iterator[Figure]:
    """NUM-SI behind the thesis's actuator, half widths .05 to .2."""
    rng = np.random.default_rng(2)
    mode = Mode(natural_frequency_rad_s=3.50178526)
    for model in ("superposed", "switched"):
        actuator = SecondOrder(
            accel=ACTUATOR.accel,
            decel=ACTUATOR.decel,
            model="switched" if model == "switched" else "superposed",
        )
        times = []
        for number in range(21):
            options = numsi.UnityBandOptions(half_width=float(rng.uniform(0.05, 0.2)))
            run = functools.partial(design, mode, actuator, SHAPERS["num_si"], options)
            if number == 0:
                run()  # its expressions are compiled once a process
            times.append(processor_ms(run))
        middle, late = np.percentile(times, [50, 95])
        yield Figure(
            what=f"`num_si`, {model}, 21 half widths 0.05-0.2: median, 95 %",
            value=f"{middle:.0f}, {late:.0f} ms",
            limit="<= 150 ms median",
            met=bool(middle <= 150),
        )


def figures() -> Iterator[Figure]:
    """Measure."""
    yield from closed_forms()
    yield from several_modes()
    yield from several_modes_behind_a_drive()
    yield from over_a_band()
