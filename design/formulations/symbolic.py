"""Complex numbers and lags in CasADi's real expressions."""

from dataclasses import dataclass, replace

from numpy.polynomial.legendre import leggauss

from design.types import Symbolic

MIN_ROOT = 1e-9
"""Distance of two poles that counts as none: the sine over it is the angle to double precision."""

RAMP_NODES = 16
"""Gauss nodes of a ramp: exact to rounding up to three periods of the plant."""

MIN_TIME_CONSTANT = 1e-9
"""Stands for a time constant of 0: at rest after any gap [rad]."""


@dataclass(frozen=True, slots=True)
class Complex:
    """A complex expression."""

    real: Symbolic
    imag: Symbolic

    def __add__(self, other: "Complex") -> "Complex":
        return Complex(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other: "Complex") -> "Complex":
        return Complex(self.real - other.real, self.imag - other.imag)

    def __mul__(self, other: "Complex") -> "Complex":
        return Complex(
            self.real * other.real - self.imag * other.imag,
            self.real * other.imag + self.imag * other.real,
        )

    def __truediv__(self, other: "Complex") -> "Complex":
        size = other.real * other.real + other.imag * other.imag
        return self * Complex(other.real / size, -other.imag / size)

    def scaled(self, factor: Symbolic) -> "Complex":
        """Return the product with a real expression."""
        return Complex(factor * self.real, factor * self.imag)


def exponential(exponent: Complex) -> Complex:
    """Return the exponential of a complex expression."""
    import casadi as ca  # noqa: PLC0415

    size = ca.exp(exponent.real)
    return Complex(size * ca.cos(exponent.imag), size * ca.sin(exponent.imag))


class SymbolicSet:
    """A lag ``G = 1 / (1 + first s + second s^2)`` whose coefficients are expressions."""

    def __init__(self, first: Symbolic, second: Symbolic) -> None:
        self.first = first
        self.second = second

    def denominator(self, s: Complex) -> Complex:
        """Return ``1 / G`` at a pole."""
        return Complex(1, 0) + s.scaled(self.first) + (s * s).scaled(self.second)

    def ringing(self, error: Symbolic, rate: Symbolic, s: Complex) -> Complex:
        """Return what an error and its rate leave over G.

        It is ``second s rate - error``, if this set stays in force.

        Parameters
        ----------
        error
            Velocity less reference [-].
        rate
            Its rate [-].
        s
            The plant's pole, in units of its frequency [-].

        Returns
        -------
        Complex
            Modal coordinate over G [-].
        """
        return s.scaled(self.second * rate) - Complex(error, 0)

    def free_motion(
        self,
        gap: Symbolic,
        error: Symbolic,
        rate: Symbolic,
        order: int,
    ) -> tuple[Symbolic, Symbolic]:
        """Return error and rate after a gap.

        The closed form is for any damping.

        Parameters
        ----------
        gap
            Phase of the plant [rad].
        error, rate
            State of the lag at the start of the gap [-].
        order
            Order of the lag, 1 or 2.

        Returns
        -------
        tuple
            Error and rate at the end [-].
        """
        import casadi as ca  # noqa: PLC0415

        if order == 1:
            return error * ca.exp(-gap / ca.fmax(self.first, MIN_TIME_CONSTANT)), rate
        corner = 1 / ca.sqrt(self.second)
        damping = self.first * corner / 2
        phase = corner * gap
        root = ca.fmax(ca.sqrt(ca.fabs(damping * damping - 1)), MIN_ROOT)
        # Either branch must be finite where the other holds: both are computed.
        under = ca.exp(-ca.fmin(damping, 1) * phase)
        slow = ca.exp(-phase / (ca.fmax(damping, 1) + root))
        oscillates = damping < 1
        even = ca.if_else(
            oscillates, under * ca.cos(root * phase), slow * (1 + ca.exp(-2 * root * phase)) / 2
        )
        odd = ca.if_else(
            oscillates,
            under * ca.sin(root * phase) / root,
            -slow * ca.expm1(-2 * root * phase) / (2 * root),
        )
        return (
            (even + damping * odd) * error + odd * rate / corner,
            -odd * corner * error + (even - damping * odd) * rate,
        )


class Ramp:
    """What limits make of a unit step, and error and rate in the set's own lag after it."""

    def __init__(self, duration: Symbolic, error: Symbolic, rate: Symbolic) -> None:
        self.duration = duration
        self.left = (error, rate)

    def factor(self, s: Complex) -> Complex:
        """Return ``(1 - exp(-s T)) / (s T)``, a ramp over a step.

        It is the mean of ``exp(-s t)`` over the ramp, by Gauss nodes: however short the ramp, value
        and slope keep their digits.

        Parameters
        ----------
        s
            The plant's pole, in units of its frequency [-].

        Returns
        -------
        Complex
            Of the mean [-].
        """
        mean = Complex(0, 0)
        for node, weight in zip(*(part.tolist() for part in leggauss(RAMP_NODES)), strict=True):
            turn = s.scaled(-self.duration * (node + 1) / 2)
            mean = mean + exponential(turn).scaled(weight / 2)
        return mean


@dataclass(frozen=True, slots=True, kw_only=True)
class AlternatingSteps:
    """What a command of steps +1, -1, +1, ... does, as expressions.

    Attributes
    ----------
    w
        The plant's frequency over its nominal value: a symbol, to be differentiated by and then
        replaced by 1.
    vibration
        ``V(w) exp(s t_n) / G_accel(s)``: in units of the unshaped step, at the last step.
    travel
        Integral of the velocity times the plant's frequency, of a command that ends at 0 [rad].
    """

    w: Symbolic
    vibration: Complex
    travel: Symbolic


def alternating_steps(
    gaps: list[Symbolic],
    lags: Symbolic,
    switched_order: int,
    amplitudes: list[Symbolic] | None = None,
) -> AlternatingSteps:
    """Return what steps up and down in turn leave at the plant's pole.

    How far they go comes with it.

    A superposed step adds ``A_i G_i(s)``; where one actuator is switched from one set to the
    other, its state adds what it would leave under the new set less what it would have left under
    the old.

    Parameters
    ----------
    gaps
        Gaps between the steps, one less than those [rad].
    lags
        As `design.formulations.lag_parameters.lag_parameters` gives them.
    switched_order
        Order of the lags of a switched actuator, 1 or 2; 0 for superposed steps of any order.
    amplitudes
        Heights of the steps, of either sign in turn; +1, -1, +1, ... if not given.

    Returns
    -------
    AlternatingSteps
        Vibration and travel.
    """
    import casadi as ca  # noqa: PLC0415

    z, first_a, second_a, first_d, second_d, *limits = ca.vertsplit(lags)
    ramps = [
        Ramp(limits[which], *limits[2 + 2 * which : 4 + 2 * which]) for which in (0, 1) if limits
    ]
    w = ca.SX.sym("w")
    s = _pole(z, w)
    sets = [SymbolicSet(first_a, second_a), SymbolicSet(first_d, second_d)]
    # Over G_accel: a constant 1 for its own steps halves the expression.
    gains = [Complex(ca.SX(1), ca.SX(0)), sets[0].denominator(s) / sets[1].denominator(s)]
    heights = [gain * ramp.factor(s) for gain, ramp in zip(gains, ramps, strict=False)] or gains
    error, rate, travel = ca.SX(0), ca.SX(0), ca.SX(0)
    vibration = Complex(ca.SX(0), ca.SX(0))
    steps = amplitudes or [1 - 2 * (index % 2) for index in range(len(gaps) + 1)]
    for index in range(len(gaps) + 1):
        amplitude = steps[index]
        after, before = sets[index % 2], sets[index % 2 - 1]
        gain_after, gain_before = gains[index % 2], gains[index % 2 - 1]
        added = heights[index % 2].scaled(amplitude)
        if switched_order and index > 0:
            gap, taken = gaps[index - 1], -steps[index - 1]
            if ramps:
                ramp = ramps[index % 2 - 1]
                still = before.free_motion(gap - ramp.duration, *ramp.left, switched_order)
                moved = before.free_motion(gap, error, rate, switched_order)
                error, rate = (a + taken * b for a, b in zip(moved, still, strict=True))
            else:
                error, rate = before.free_motion(gap, error + taken, rate, switched_order)
            gained = gain_after * after.ringing(error, rate, s)
            added = added + gained - gain_before * before.ringing(error, rate, s)
            travel += (after.first - before.first) * error
            travel += (after.second - before.second) * rate
        left = sum(gaps[index:], ca.SX(0))
        vibration = vibration + added * exponential(s.scaled(left))
        delay = after.first + (ramps[index % 2].duration / 2 if ramps else 0)
        travel += amplitude * (left - delay)
    return AlternatingSteps(w=w, vibration=vibration, travel=travel)


def with_swing(
    steps: AlternatingSteps, gaps: list[Symbolic], lags: Symbolic, swing: Symbolic
) -> AlternatingSteps:
    """Add what the payload swings already at the first step.

    It is ``-(d' - conj(s) d)`` there.

    Parameters
    ----------
    steps
        What the steps leave.
    gaps, lags
        As in `alternating_steps`.
    swing
        Deflection times the plant's frequency over the speed, its rate over the speed, the power
        of w that both go by, and the phase until the actuator answers its first step, shape (4,).

    Returns
    -------
    AlternatingSteps
        The same travel; vibration with the swing.
    """
    import casadi as ca  # noqa: PLC0415

    z, first, second, *_ = ca.vertsplit(lags)
    deflection, rate, power, delay = ca.vertsplit(swing)
    s = _pole(z, steps.w)
    vector = Complex(s.real * deflection - rate, -s.imag * deflection).scaled(steps.w**power)
    rung = exponential(s.scaled(sum(gaps, delay)))
    added = vector * SymbolicSet(first, second).denominator(s) * rung
    return replace(steps, vibration=steps.vibration + added)


def _pole(z: Symbolic, w: Symbolic) -> Complex:
    import casadi as ca  # noqa: PLC0415

    return Complex(-z * w, w * ca.sqrt(1 - z * z))


def with_slopes(steps: AlternatingSteps, derivatives: int) -> list[Symbolic]:
    """Return the equations V = 0 and some derivatives in w, at w = 1.

    Parameters
    ----------
    steps
        What the steps leave.
    derivatives
        Order of the highest derivative, >= 0.

    Returns
    -------
    list
        A pair of real and imaginary part for V and each derivative.
    """
    import casadi as ca  # noqa: PLC0415

    equations = [ca.vertcat(steps.vibration.real, steps.vibration.imag)]
    for _ in range(derivatives):
        equations.append(ca.jacobian(equations[-1], steps.w))
    return [ca.substitute(one, steps.w, 1) for one in equations]
