"""Live shaping in Structured Text: what its blocks do by the kind of the drive."""

SWITCHED = """\
new_re := re - (gains[4 * lag] * error + gains[4 * lag + 2] * rate);
new_im := im - (gains[4 * lag + 1] * error + gains[4 * lag + 3] * rate);
new_error := error - (after - before);
new_re := new_re + gains[4 * new_lag] * new_error + gains[4 * new_lag + 2] * rate;
new_im := new_im + gains[4 * new_lag + 1] * new_error + gains[4 * new_lag + 3] * rate;
"""


ONE_LAG = {
    "LAGVARS": "",
    "LAG": "",
    "SWITCHED": """\
new_re := re - gains[4 * new_lag] * (after - before);
new_im := im - gains[4 * new_lag + 1] * (after - before);
new_error := 0.0;
""",
    "EARLYSLOPE": "",
    "SLOPE": "",
    "EARLYSWITCH": "",
    "LASTSWITCH": "",
}
"""Of drives whose steps add up: only the swing has a state."""


FIRST_ORDER = {
    "LAGVARS": "",
    "LAG": "ee := EXP(-time_s / first_s[lag]);\n",
}


SECOND_ORDER = {
    "LAGVARS": """\
    phase : $REAL;
    angle : $REAL;
    even : $REAL;
    odd : $REAL;
    slow : $REAL;
    term : $REAL;
    mean : $REAL;
    k : DINT;
""",
    "LAG": """\
phase := corner_rad_s[lag] * time_s;
angle := root[lag] * phase;
IF damping[lag] < 1.0 THEN
    fade := EXP(-damping[lag] * phase);
    even := fade * COS(angle);
    odd := fade * phase;
    IF ABS(angle) > 0.0 THEN
        odd := odd * (SIN(angle) / angle);
    END_IF;
ELSE
    slow := EXP(-phase / (damping[lag] + root[lag]));
    fade := EXP(-2.0 * angle);
    even := slow * (1.0 + fade) / 2.0;
    IF ABS(angle) < $SHORTTURN THEN
        term := 1.0;
        mean := 1.0;
        FOR k := 2 TO $SERIES DO
            term := term * (-2.0 * angle / $TOREAL(k));
            mean := mean + term;
        END_FOR;
        odd := slow * phase * mean;
    ELSE
        odd := slow * (1.0 - fade) / (2.0 * root[lag]);
    END_IF;
END_IF;
ee := even + damping[lag] * odd;
er := odd / corner_rad_s[lag];
re := -odd * corner_rad_s[lag];
rr := even - damping[lag] * odd;
""",
}


def _slope(name: str, lag: str, order: int) -> str:
    """Return the slope of error and rate behind a lag."""
    if order == 1:
        return f"        {name}_error := -error / first_s[{lag}];\n"
    return (
        f"        {name}_error := rate;\n"
        f"        {name}_rate := -(error + first_s[{lag}] * rate) / second_s2[{lag}];\n"
    )


def _turned(name: str, old: str, new: str) -> str:
    """Return how a slope passes a switch from one lag to another."""
    return "".join(
        f"        {name}_{part} := {name}_{part}\n"
        f"            + (gains[4 * {new}{a}] - gains[4 * {old}{a}]) * {name}_error\n"
        f"            + (gains[4 * {new}{b}] - gains[4 * {old}{b}]) * {name}_rate;\n"
        for part, a, b in (("re", "", " + 2"), ("im", " + 1", " + 3"))
    )


def switched_parts(order: int) -> dict[str, str]:
    """Return the parts of a switched drive."""
    return {
        "SWITCHED": SWITCHED,
        "EARLYSLOPE": _slope("early", "lag_wanted", order),
        "SLOPE": _slope("slope", "lag_other", order),
        "EARLYSWITCH": _turned("early", "lag_wanted", "lag_other"),
        "LASTSWITCH": _turned("early", "lag_other", "switched.new_lag")
        + _turned("slope", "lag_other", "switched.new_lag"),
    }
