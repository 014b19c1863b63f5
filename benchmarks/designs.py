"""One NUMZVD design against CasADi used by hand, and a sensitivity curve."""

import math
from collections.abc import Iterator
from dataclasses import replace
from statistics import median

import casadi as ca
import numpy as np

from benchmarks.measure import Figure, alternating_medians, ratio
from design.analysis.residual import evenly_spaced_vectors
from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.fields import Axis
from design.formulations.published_times import ZVD_POLYNOMIALS
from design.maps.field_map import field_map
from design.maps.map_case import MapCase
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.commands import convolve, pulse
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.moves.playback import motion
from design.pipeline import design
from design.recommendations.recommendation import recommend
from design.recommendations.requirements import Requirements
from design.shapers.registry import SHAPERS

CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
ACTUATOR = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
)
QUIET = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-12}
SEED = 2 * math.pi * np.array(ZVD_POLYNOMIALS)[:, 0]


def zero_vibration(t: ca.MX | ca.SX, w: ca.MX | ca.SX | float) -> ca.MX | ca.SX:
    """Write V(w) of five impulses behind the thesis's actuator, undamped, as a user would."""

    def response_of_set(lag_w: float, lag_z: float) -> tuple[ca.SX, ca.SX]:
        x = w * CRANE.mode.natural_frequency_rad_s / lag_w
        size = (1 - x * x) ** 2 + (2 * lag_z * x) ** 2
        return (1 - x * x) / size, -2 * lag_z * x / size

    real, imag = 0, 0
    sets = response_of_set(20.0, 0.8), response_of_set(50.0, 1.5)
    times = ca.vertcat(0, t)
    for index in range(5):
        gain, phase = sets[index % 2]
        sign = 1 - 2 * (index % 2)
        c, s = ca.cos(w * times[index]), ca.sin(w * times[index])
        real += sign * (gain * c + phase * s)
        imag += sign * (phase * c - gain * s)
    return ca.vertcat(real, imag)


def bare_solver() -> ca.Function:
    """Return the same problem as one reused `nlpsol`."""
    t, w = ca.SX.sym("t", 4), ca.SX.sym("w")
    v = zero_vibration(t, w)
    order = ca.vertcat(t[0], ca.diff(t))
    equations = ca.vertcat(v, ca.jacobian(v, w))
    program = {"x": t, "p": w, "f": t[3], "g": ca.vertcat(equations, order)}
    return ca.nlpsol("bare", "ipopt", program, QUIET)


def opti_design() -> ca.DM:
    """Build and solve the same problem with CasADi's Opti, as its examples do."""
    opti = ca.Opti()
    t = opti.variable(4)
    w = ca.MX.sym("w")
    v = zero_vibration(t, w)
    equations = ca.substitute(ca.vertcat(v, ca.jacobian(v, w)), w, 1.0)
    opti.minimize(t[3])
    opti.subject_to(equations == 0)
    opti.subject_to(t[0] >= 0)
    for index in range(3):
        opti.subject_to(t[index + 1] >= t[index])
    opti.set_initial(t, SEED)
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes", "tol": 1e-12})
    return opti.solve().value(t)


def figures() -> Iterator[Figure]:
    """Measure."""
    kind, mode, wanted = SHAPERS["numzvd"], CRANE.mode, SensitivityRange()
    solver = bare_solver()
    bounds = {"lbg": [0] * 8, "ubg": [0] * 4 + [math.inf] * 4}
    found = design(CRANE, ACTUATOR, kind)
    phases = np.asarray(solver(x0=SEED, p=1.0, **bounds)["x"]).ravel()
    times = found.impulses.times_s[1:]
    if not np.allclose(phases / mode.natural_frequency_rad_s, times, atol=1e-8):
        raise RuntimeError(f"the peer solves another problem: {phases} against {times}")

    switched = replace(ACTUATOR, model="switched")

    def complete(actuator: SecondOrder) -> object:
        return sensitivity(design(CRANE, actuator, kind).impulses, mode, actuator, wanted)

    seconds = alternating_medians({
        "design": lambda: complete(ACTUATOR),
        "switched": lambda: complete(switched),
        "nlpsol": lambda: solver(x0=SEED, p=1.0, **bounds),
        "opti": opti_design,
    })
    took = {name: 1e6 * median(values) for name, values in seconds.items()}
    for peer, limit in (("nlpsol", 1.5), ("opti", 0.5)):
        share = ratio(seconds, "design", peer)
        yield Figure(
            what=f"NUMZVD design, certificate, 201-point curve / {peer}",
            value=f"{share:.2f} ({took['design']:.0f} / {took[peer]:.0f} us)",
            limit=f"<= {limit}",
            met=share <= limit,
            over_peer=share,
        )
    share = ratio(seconds, "switched", "design")
    yield Figure(
        what="the same behind a switched actuator / superposed",
        value=f"{share:.2f} ({took['switched']:.0f} / {took['design']:.0f} us)",
        limit="<= 2",
        met=share <= 2,
    )
    yield from _curves(found.impulses)


def _curves(shaper: Impulses) -> Iterator[Figure]:
    """Measure a sensitivity curve and a simulation of a whole move."""
    pole = CRANE.mode.pole_rad_s
    move, times = convolve(pulse(2.0), shaper), np.linspace(0, 6, 10_000)
    seconds = alternating_medians({
        "curve": lambda: np.abs(
            evenly_spaced_vectors(shaper, 0.5 * pole, 1.5 * pole, 1000, ACTUATOR)
        ),
        "move": lambda: motion(CRANE, ACTUATOR, move, 0.2, times),
    })
    microseconds = 1e6 * median(seconds["curve"])
    yield Figure(
        what="1,000-point sensitivity curve of five impulses",
        value=f"{microseconds:.0f} us",
        limit="<= 150 us",
        met=microseconds <= 150,
    )
    milliseconds = 1e3 * median(seconds["move"])
    yield Figure(
        what="simulation of a move at 10,000 times",
        value=f"{milliseconds:.1f} ms",
        limit="<= 5 ms",
        met=milliseconds <= 5,
    )
    yield from _moves_and_maps()


def _moves_and_maps() -> Iterator[Figure]:
    """Measure a move too short for start and stop, a map, and a recommendation."""
    kind = SHAPERS["numzvd"]
    shaper = design(CRANE, ACTUATOR, kind).impulses
    x = Axis(
        path=("actuator", "accel", "natural_frequency_rad_s"), values=np.linspace(10.0, 60.0, 100)
    )
    y = Axis(path=("plant", "cable_length_m"), values=np.linspace(0.4, 1.4, 100))
    case = MapCase(plant=CRANE, actuator=ACTUATOR, shaper=shaper)
    seconds = alternating_medians(
        {
            "move": lambda: maneuver(CRANE, ACTUATOR, kind, speed_m_s=0.2, distance_m=0.05),
            "map": lambda: field_map(case, x, y),
            "recommendation": lambda: recommend(CRANE, ACTUATOR, Requirements()),
        },
        rounds=5,
        calls=2,
    )
    for name, what, limit_s in (
        ("move", "short move, start and stop solved as one", 0.1),
        ("map", "map of 100 x 100", 0.5),
        ("recommendation", "recommendation for the crane, 5 % over 15 %, every kind", 0.3),
    ):
        took = median(seconds[name])
        yield Figure(
            what=what,
            value=f"{1e3 * took:.0f} ms",
            limit=f"<= {1e3 * limit_s:.0f} ms",
            met=took <= limit_s,
        )
