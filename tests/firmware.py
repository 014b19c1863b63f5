"""Readers of the lines for printers' firmware, by the rules of that firmware."""

import re
import shlex
from itertools import accumulate, pairwise

import numpy as np

from design.export.klipper_shapers import (
    MAX_DAMPING_RATIOS,
    MAX_IMPULSES,
    klipper_impulses,
    older_klipper_impulses,
)
from design.model.impulses import Impulses


class RefusedError(Exception):
    """The firmware refuses a line."""


def lines_of(text: str) -> list[str]:
    """Return the lines that a machine runs, without comments."""
    lines = (line.partition(";")[0].strip() for line in text.splitlines())
    return [line for line in lines if line]


def line_of_x(text: str) -> str:
    """Return the line for X of a file of one row, where that for Y says the same."""
    one, other = lines_of(text)
    if other != re.sub(r"_X\b", "_Y", one):
        raise RefusedError(other)
    return one


def klipper_reads(line: str, *, older: bool = False) -> Impulses:
    """Read SET_INPUT_SHAPER as klippy/gcode.py and klippy/extras/input_shaper.py do.

    ``older``: as before 2025-09-16, and as Kalico.
    """
    command, *words = shlex.split(line)
    if command.upper() != "SET_INPUT_SHAPER":
        raise RefusedError(command)
    given = {key.upper(): value for key, value in (word.split("=", 1) for word in words)}
    axis = next(iter(given))[-1]
    names = [f"{name}_{axis}" for name in ("SHAPER_TYPE", "SHAPER_FREQ", "DAMPING_RATIO")]
    # Of one axis, as the lines of either axis are: what a line does not name stays.
    if axis not in "XY" or set(given) != set(names):
        raise RefusedError(line)
    shaper, hertz, damping = given[names[0]].lower(), float(given[names[1]]), float(given[names[2]])
    brackets = re.match(r"(\w+)\s*\((.*)\)$", shaper)
    name = shaper if brackets is None else brackets[1]
    if name not in MAX_DAMPING_RATIOS or (older and brackets is not None):
        raise RefusedError(shaper)
    if not 0 <= damping <= MAX_DAMPING_RATIOS[name] or not hertz > 0:
        raise RefusedError(line)
    if older:
        return older_klipper_impulses(name, hertz, damping)
    pairs = re.findall(r"(?:(\w+)\s*=\s*)?\s*([\d.]+)", "" if brackets is None else brackets[2])
    parameters = {key: float(value) if "." in value else int(value) for key, value in pairs}
    taken = {"mzv": {"n", "t", "tau"}, "ei": {"v_tol"}}.get(name, set())
    if not set(parameters) <= taken or parameters.get("n", 3) > MAX_IMPULSES:
        raise RefusedError(shaper)
    return klipper_impulses(
        name,
        hertz,
        damping,
        impulses=int(parameters.get("n", 3)),
        periods=float(parameters.get("t", 0.75)),
        tolerance=float(parameters.get("v_tol", 0.05)),
    )


M593 = re.compile(r'M593 P"custom" H([\d.:]+) T([\d.:]+)\Z')
MAX_NUMBERS = 4


def m593_numbers(line: str) -> list[list[float]]:
    """Return the numbers behind H and behind T."""
    match = M593.match(line)
    if match is None:
        raise RefusedError(line)
    read = [[float(one) for one in group.split(":")] for group in match.groups()]
    if len(read[0]) != len(read[1]) or not 1 <= len(read[0]) <= MAX_NUMBERS:
        raise RefusedError(line)
    return read


def reprap_36_reads(line: str) -> Impulses:
    """Read M593 as RepRapFirmware 3.6 does: own amplitudes, delays from the first impulse."""
    heights, delays = m593_numbers(line)
    return Impulses(
        times_s=np.array([0.0, *delays]), amplitudes=np.array([*heights, 1 - sum(heights)])
    )


def reprap_35_reads(line: str) -> Impulses:
    """Read M593 as RepRapFirmware 3.4 does: acceleration in force, and for how long."""
    heights, durations = m593_numbers(line)
    steps = [after - before for before, after in pairwise([0.0, *heights, 1.0])]
    return Impulses(
        times_s=np.array(list(accumulate([0.0, *durations]))), amplitudes=np.array(steps)
    )


OF_MARLIN = re.compile(r"M593 ([XY]) F([\d.]+) D([\d.]+)\Z")


def marlin_reads(line: str) -> Impulses:
    """Read M593 as Marlin does: ZV, heights in 128ths, half a period of F between them."""
    match = OF_MARLIN.match(line)
    if match is None:
        raise RefusedError(line)
    frequency_hz, zeta = float(np.float32(match[2])), float(np.float32(match[3]))
    if not 0 <= zeta <= 0.99:
        raise RefusedError(line)
    echo = 64.0
    if zeta > 0:
        cubic = np.polynomial.Polynomial([64.44056192, -99.02008832, -7.58095488, 43.073216])
        echo = float(np.floor(cubic(zeta)))
    return Impulses(
        times_s=np.array([0.0, 1 / (2 * frequency_hz)]),
        amplitudes=np.array([1 - echo / 128, echo / 128]),
    )
