"""Terms of the sum that a residual is."""

import numpy as np

from design.analysis.residual import join_sets
from design.analysis.step_contributions import step_contributions
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.types import ComplexArray


def terms_of_residual(impulses: Impulses, pole_rad_s: complex, actuator: Actuator) -> ComplexArray:
    """Return what each change of the reference adds to the residual.

    A step is one change, a ramp too; one that reverses the command is two. Phases count from the
    first step, whose term is then real.

    Parameters
    ----------
    impulses
        The command.
    pole_rad_s
        Upper pole of the mode [rad/s].
    actuator
        The actuator.

    Returns
    -------
    ComplexArray
        Terms of the sum in `residual_vectors`, shape (n,) [-].
    """
    steps = step_contributions(impulses, actuator)
    columns = steps.columns.astype(np.complex128)
    if steps.ramps is not None and steps.heights is not None:
        factors = steps.ramps.factors(np.array([pole_rad_s]))
        columns[:, :2] += factors[:, None] * steps.heights
    turns = pole_rad_s * steps.until_end_s - 1j * pole_rad_s.imag * steps.until_end_s[0]
    terms = np.exp(turns)[:, None] * columns
    return join_sets(terms, np.array([pole_rad_s]), actuator)
