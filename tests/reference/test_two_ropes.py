"""Two parallel ropes swing as a pendulum of their length, wherever the centre of the load is."""

import numpy as np
import pytest

from design.model.plants.pendulum import Pendulum

STIFF_N_M = 1e10
"""A rope that hardly stretches: the load bounces at 16,000 rad/s, and swings at 3 [N/m]."""


def slowest_rad_s(
    length_m: float, apart_m: float, below_m: float, inertia_share: float, turn_rad: float
) -> float:
    """Return the lowest frequency of a rigid load on two ropes, its turning among the unknowns.

    The ropes hang from points that are ``apart_m``, each turned from the vertical by ``turn_rad``,
    and hold the load ``below_m`` above its centre. Tension and stretching are linearized.
    """
    mass, gravity = 40.0, 9.81
    stiffness = np.zeros((3, 3))  # across, up, turn about the centre
    tension = mass * gravity / 2 / np.cos(turn_rad)
    for side in (-1.0, 1.0):
        direction = np.array([side * np.sin(turn_rad), np.cos(turn_rad)])  # up along the rope
        arm = np.array([side * (apart_m / 2 - length_m * np.sin(turn_rad)), below_m])
        moves = np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]])  # of the rope's lower end
        along = np.outer(direction, direction)
        rope = STIFF_N_M * along + tension / length_m * (np.eye(2) - along)
        stiffness += moves.T @ rope @ moves
        stiffness[2, 2] += tension * (direction @ arm)  # the pull turns with its arm
    masses = np.diag([mass, mass, mass * inertia_share])
    squares = np.linalg.eigvals(np.linalg.solve(masses, stiffness)).real
    return float(np.sqrt(squares.min()))


@pytest.mark.parametrize("below_m", [0.0, 0.2, 0.6])
@pytest.mark.parametrize("inertia_share", [0.01, 0.2])
def test_parallel_ropes_swing_at_the_frequency_of_their_length(
    below_m: float, inertia_share: float
) -> None:
    crane = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
    found = slowest_rad_s(0.8, 0.3, below_m, inertia_share, 0.0)
    assert found == pytest.approx(crane.mode.natural_frequency_rad_s, rel=1e-6)


def test_ropes_that_converge_have_no_length_of_their_own() -> None:
    light, heavy = (slowest_rad_s(0.8, 0.3, 0.2, share, 0.1) for share in (0.01, 0.2))
    assert abs(light / heavy - 1) > 1e-3
