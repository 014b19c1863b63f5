"""The Runge-Kutta method against the conditions of its order."""

import math

import numpy as np

from design.rig.tableau import FIFTH, NODES, STAGES, THIRD, WEIGHTS


def test_the_method_meets_the_conditions_of_order_eight() -> None:
    assert np.allclose(STAGES.sum(axis=1), NODES, rtol=0, atol=1e-14)
    for power in range(8):  # quadrature
        assert math.isclose(WEIGHTS @ NODES**power, 1 / (power + 1), abs_tol=1e-14)
    tall = np.ones(NODES.size)
    for order in range(1, 9):  # the tall trees: a linear equation
        assert math.isclose(WEIGHTS @ tall, 1 / math.factorial(order), abs_tol=1e-14)
        tall = STAGES @ tall
    for power in range(7):  # one branch on top of a bush
        assert math.isclose(
            WEIGHTS @ STAGES @ NODES**power, 1 / ((power + 1) * (power + 2)), abs_tol=1e-14
        )


def test_the_differences_are_of_lower_order() -> None:
    for power in range(5):
        assert abs(FIFTH @ NODES**power) < 1e-14
    for power in range(3):
        assert abs(THIRD @ NODES**power) < 1e-14
    assert abs(FIFTH @ NODES**5) > 1e-6
    assert abs(THIRD @ NODES**3) > 1e-6
