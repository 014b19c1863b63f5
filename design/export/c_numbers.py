"""Numbers as C has them: double, or float where the program says so."""

import math

from design.export.program import decimal

REAL = """\
#ifndef SHAPERSMITH_REAL_DEFINED
#define SHAPERSMITH_REAL_DEFINED
#ifdef SHAPERSMITH_FLOAT
typedef float shapersmith_real;
#define SHAPERSMITH_C(value) value##f
#define SHAPERSMITH_SQRT(value) sqrtf(value)
#else
typedef double shapersmith_real;
#define SHAPERSMITH_C(value) value
#define SHAPERSMITH_SQRT(value) sqrt(value)
#endif
#endif
"""
"""The type of numbers, defined once in a program, however many headers it includes."""


def literal(value: float) -> str:
    """Return a number as a literal of that type; not-a-number as NAN."""
    return "NAN" if math.isnan(value) else f"SHAPERSMITH_C({decimal(value)})"
