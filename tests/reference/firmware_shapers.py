"""Shapers of machine firmware, and what they leave."""

import math

import numpy as np

from design.claims import Promise
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.shaper_table import IDEAL


def hertz(damping_ratio: float = 0.0) -> Mode:
    """Return a mode of one hertz: times are periods."""
    return Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=damping_ratio)


def shaper(name: str, damping_ratio: float = 0.0, options: object = None) -> Impulses:
    return design(hertz(damping_ratio), IDEAL, SHAPERS[name], options).impulses


def decayed(undamped: Impulses, z: float) -> Impulses:
    """Amplitudes times K^(2 t / T), times over sqrt(1 - z^2): the usual way to add damping."""
    damped = math.sqrt(1 - z * z)
    amplitudes = undamped.amplitudes * np.exp(-2 * math.pi * z / damped * undamped.times_s)
    return Impulses(
        times_s=undamped.times_s / damped, amplitudes=amplitudes / float(amplitudes.sum())
    )


def proven_band(name: str, z: float) -> tuple[Promise, Promise]:
    """Return what a shaper of 5 % promises: at the nominal frequency, and over its band."""
    nominal, band = design(hertz(z), IDEAL, SHAPERS[name]).certificate.claims
    return (
        Promise(quantity="residual", limit=nominal.limit),
        Promise(quantity="band", limit=band.limit, band=band.band),
    )
