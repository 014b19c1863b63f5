"""How tables solve a kind of shaper without the pipeline.

The kernel of tables is compiled once, for every kind whose equations are as many as its unknowns,
and solves many rows side by side. What it has to know of a kind is here; a kind that says nothing
of it has rows that are designs, one by one.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class CompiledRows:
    """How the compiled kernel of tables solves a kind of as many equations as unknowns."""

    # Whether the shaper knows no actuator: its rows are solved for an ideal one
    for_ideal: bool = False
    # Whether it is a closed form for an undamped plant behind superposed steps
    closed_form_undamped: bool = False
