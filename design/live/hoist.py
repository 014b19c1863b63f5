"""A hoist while a crane is driven live: its course, and what drive and swing are worth at its end.

While the cable is hoisted the coordinate of the swing is what is seen of it at the end of the
hoist, in the mode of the last length. It is constant between switches, as long as what the lags
will still leave is counted in. That is linear in the lag's error e and rate v', ``A(t) e + B(t)
v'``: with the kernel k of `design.response.hoisting_kernel` and ``v - r + first v' + second v'' =
0`` it obeys ``A' = B / second`` and ``B' = -k - A + B first / second``, backward from the end.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from design.checks import require_scale
from design.errors import InvalidInputError
from design.model.actuators.rate_limited import Unlimited
from design.model.lags import Lag
from design.model.plants.hoisting import Hoisting, LengthCourse
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.response.hoisting_kernel import HoistingKernel, hoisting_kernel
from design.types import ComplexArray, FloatArray

ORDER = 20
"""Terms of the series of a panel: rounding is reached at some fifteen."""

PANEL = 2.0
"""Longest panel over the inverse of what turns or decays in it [-]."""

MAX_WOUND = 0.2
"""Longest panel over the time to where the cable would be of no length [-]."""

PARTS = 4
"""Gains of a set: A and B, complex."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HoistRequest:
    """A length of the cable that is asked for, and how long the way there takes.

    Attributes
    ----------
    cable_length_m
        From the trolley to the load at the end, > 0 [m].
    over_s
        How long it takes, > 0; the rate is even [s].
    """

    cable_length_m: float
    over_s: float

    def __post_init__(self) -> None:
        require_scale("over_s", self.over_s)
        if not self.cable_length_m > 0:
            raise InvalidInputError(
                "cable_length_m",
                self.cable_length_m,
                "> 0: no cable is hoisted to or through its suspension",
                code="hoisted_through_zero",
            )
        require_scale("cable_length_m", self.cable_length_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class Hoist:
    """A cable that goes evenly from a length to another.

    Attributes
    ----------
    begin_s, end_s
        When [s].
    first, last
        The crane on either length.
    """

    begin_s: float
    end_s: float
    first: Pendulum
    last: Pendulum

    @property
    def rate_m_s(self) -> float:
        """How fast the cable grows during it [m/s]."""
        return (self.last.cable_length_m - self.first.cable_length_m) / (self.end_s - self.begin_s)

    def length_m(self, time_s: float) -> float:
        """Return the length at a time [m]."""
        if time_s >= self.end_s:
            return self.last.cable_length_m
        if time_s <= self.begin_s:
            return self.first.cable_length_m
        return self.first.cable_length_m + self.rate_m_s * (time_s - self.begin_s)

    @property
    def plant(self) -> Hoisting:
        """The same, its times counted from the begin."""
        course = LengthCourse(
            times_s=(0.0, self.end_s - self.begin_s),
            values=(self.first.cable_length_m, self.last.cable_length_m),
        )
        return Hoisting(
            cable_length_m=course,
            damping_ratio=self.last.damping_ratio,
            gravity_m_s2=self.last.gravity_m_s2,
        )

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The mode in which its swing is seen, that of the last length."""
        return self.last.modes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gains:
    """What lags will still leave at the end of a hoist, of an error and of a rate.

    Attributes
    ----------
    ends_s
        Ends of panels, from the begin of the hoist on, shape (n + 1,) [s].
    values, slopes
        Chebyshev series of A and B of both sets, and of their rates, shape (n, ORDER, 2 PARTS):
        real and imaginary part of each.
    last
        A and B at the end, shape (2 PARTS,).
    pole
        Of the mode at the end: real and imaginary part, shape (2,) [rad/s].
    """

    ends_s: FloatArray
    values: FloatArray
    slopes: FloatArray
    last: FloatArray
    pole: FloatArray


@lru_cache(maxsize=64)
def gains_of(actuator: Unlimited, hoist: Hoist) -> Gains:
    """Return what the lags of a drive will still leave.

    Parameters
    ----------
    actuator, hoist
        The drive, and the hoist with its times.

    Returns
    -------
    Gains
        At each time from its begin on.
    """
    plant = hoist.plant
    kernel = hoisting_kernel(plant)
    lags = actuator.accel_lag, actuator.decel_lag
    ends = _panels(plant, lags)
    lengths = np.diff(ends)
    nodes = -np.cos(np.pi * np.arange(ORDER) / (ORDER - 1))
    times = ends[:-1, None] + lengths[:, None] * (1 + nodes) / 2
    kernels = kernel.at(times.ravel()).reshape(times.shape)
    at_nodes = np.zeros((len(lengths), ORDER, PARTS), dtype=np.complex128)
    for which, lag in enumerate(lags):
        at_nodes[..., 2 * which : 2 * which + 2] = _of_lag(lag, kernel, kernels, lengths, nodes)
    inverse = np.linalg.inv(chebyshev.chebvander(nodes, ORDER - 1))
    series = np.einsum("ij,njk->nik", inverse, at_nodes)
    rates = np.zeros_like(series)
    rates[:, :-1] = np.moveaxis(chebyshev.chebder(np.moveaxis(series, 1, 0)), 0, 1)
    rates *= 2 / lengths[:, None, None]
    return Gains(
        ends_s=hoist.begin_s + ends,
        values=np.ascontiguousarray(series).view(np.float64),
        slopes=np.ascontiguousarray(rates).view(np.float64),
        last=np.ascontiguousarray(at_nodes[-1, -1]).view(np.float64),
        pole=np.array([kernel.pole_rad_s.real, kernel.pole_rad_s.imag]),
    )


def _panels(plant: Hoisting, lags: tuple[Lag, Lag]) -> FloatArray:
    """Return ends of panels from 0 on: short ones last, where the kernel has a kink behind it."""
    course = plant.cable_length_m
    fastest = float(np.sqrt(plant.gravity_m_s2 / min(course.values)))
    first_m, last_m = course.values
    wound_s = min(course.values) / abs(last_m - first_m) * plant.end_s if first_m != last_m else 0.0
    longest = PANEL / fastest
    if wound_s:
        longest = min(longest, MAX_WOUND * wound_s)
    step = min([longest, *(PANEL / _fastest(lag) for lag in lags if lag.first_s or lag.second_s2)])
    back = [0.0]
    while back[-1] < plant.end_s:
        back.append(back[-1] + step)
        step = min(back[-1], longest)
    # The panel that is left over is spread: none is of no length.
    ends: FloatArray = (plant.end_s / back[-1]) * (back[-1] - np.array(back[::-1]))
    ends[-1] = plant.end_s
    return ends


def _fastest(lag: Lag) -> float:
    """Return the magnitude of a lag's faster pole [rad/s]."""
    if lag.second_s2 == 0:
        return 1 / lag.first_s
    roots = np.roots([lag.second_s2, lag.first_s, 1.0])
    return float(np.abs(roots).max())


def _of_lag(
    lag: Lag,
    kernel: HoistingKernel,
    kernels: ComplexArray,
    lengths_s: FloatArray,
    nodes: FloatArray,
) -> ComplexArray:
    """Return A and B of a lag at the nodes of panels, by collocation, shape (n, ORDER, 2)."""
    found = np.zeros((*kernels.shape, 2), dtype=np.complex128)
    if lag.first_s == 0 and lag.second_s2 == 0:
        found[..., 0] = -kernels
        return found
    pole = kernel.pole_rad_s
    gain = 1 / (1 + pole * (lag.first_s + pole * lag.second_s2))
    order = 2 if lag.second_s2 else 1
    end = np.array([-gain, gain * lag.second_s2 * pole])[:order]
    pulls = (
        np.array([[0.0, 1 / lag.second_s2], [-1.0, lag.first_s / lag.second_s2]])
        if lag.second_s2
        else np.array([[1 / lag.first_s]])
    )
    driven = np.array([0.0, -1.0]) if lag.second_s2 else np.array([1 / lag.first_s])
    derive = np.linalg.solve(
        chebyshev.chebvander(nodes, ORDER - 1).T,
        np.vstack([chebyshev.chebval(nodes, chebyshev.chebder(row)) for row in np.eye(ORDER)]),
    ).T
    for panel in range(len(lengths_s) - 1, -1, -1):
        system = np.kron(derive * (2 / lengths_s[panel]), np.eye(order)) - np.kron(
            np.eye(ORDER), pulls
        )
        right = np.kron(kernels[panel], driven)
        system[-order:] = 0.0
        system[-order:, -order:] = np.eye(order)
        right[-order:] = end
        solved = np.linalg.solve(system, right).reshape(ORDER, order)
        found[panel, :, :order] = solved
        end = solved[0]
    return found
