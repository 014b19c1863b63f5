"""NUMZVD: five impulses of unity magnitude, whose residual is flat over the frequency."""

from design.formulations.behind_limits import behind_limits
from design.formulations.formulation import Formulation
from design.formulations.settled_steps import settled_steps
from design.formulations.unity_magnitude import ZERO_VIBRATION_DERIVATIVE
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.model.actuators.rate_limited import RateLimited
from design.shapers.actuators import EVERY_ACTUATOR
from design.shapers.compiled_rows import CompiledRows
from design.shapers.kind import DesignCase, KindOf
from design.shapers.numzv import SOURCE
from design.shapers.settle_options import SettleOptions


def numzvd(case: DesignCase[SettleOptions]) -> Formulation:
    """Formulate the fastest five-impulse shaper flat in frequency.

    V = 0 and dV/dw = 0, the actuator's own slope included, which the thesis omits. Behind
    limits it has as many impulses as the fastest course of the reference takes.
    """
    if isinstance(case.actuator, RateLimited) and not case.options.settle:
        return behind_limits(
            case.modes,
            case.actuator,
            derivatives=1,
            max_duration_periods=case.options.max_duration_periods,
        )
    formulate = settled_steps if case.options.settle else unity_magnitude_problem
    return formulate(
        ZERO_VIBRATION_DERIVATIVE,
        case.mode,
        case.actuator,
        max_duration_periods=case.options.max_duration_periods,
    )


NUMZVD = KindOf(
    name="numzvd",
    summary="Minimum-time unity magnitude, zero vibration and slope, asymmetric actuator.",
    source=f"{SOURCE}, eqs. 3.44-3.46, slope exact",
    claims=("residual", "slope"),
    options=SettleOptions,
    actuators=EVERY_ACTUATOR,
    formulation=numzvd,
    compiled_rows=CompiledRows(),
)
