"""Live shaping as a C99 header: a function that is called once a cycle and solves anew.

The functions do what the blocks of Structured Text do (`design.export.live_blocks.text`). The
algorithm is described in `design.export.live_blocks.block`.
"""

from string import Template

from design.export.c_numbers import REAL, literal
from design.export.header import TOOL
from design.export.live_blocks.block import COUNTED, LiveBlock
from design.export.live_blocks.c_motion import BOUNDS, FLOW, LAGS, STATE, WAVES
from design.export.live_blocks.c_solve import PLAN, SOLVE
from design.export.live_blocks.c_step import (
    CALL,
    REPLAN,
    SEEN_LENGTH,
    STEP,
    TAKE_LENGTH,
    TAKE_NO_LENGTH,
    WAIT,
)
from design.export.program import HASH_DIGITS, decimal
from design.model.plants.pendulum import Pendulum


def live_in_c(block: LiveBlock) -> str:
    """Return live shaping as a header.

    Parameters
    ----------
    block
        The machine.

    Returns
    -------
    str
        Numbers are ``double``, or ``float`` where ``SHAPERSMITH_FLOAT`` is defined ahead.

    Raises
    ------
    InvalidInputError
        If a number is not finite.
    """
    name = block.name
    guard = f"{name.upper()}_{block.sha256[:HASH_DIGITS].upper()}_H"
    given = {
        "NAME": name,
        "UPPER": name.upper(),
        **{key: str(value) for key, value in block.counts.items()},
        **{key: literal(value) for key, value in block.constants.items()},
        "BOUND": f"{name.upper()}_BOUND",
        "SINGLE": literal(COUNTED["REAL"]),
        "DOUBLE": literal(COUNTED["LREAL"]),
        "LONGEST": f"{block.longest_cycle_s:.4g}",
        "LONGESTC": literal(block.longest_cycle_s),
        "CYCLE": decimal(block.example_cycle_s),
        **_cable(block),
    }
    given |= {key: Template(text).substitute(given) for key, text in LAGS[block.order].items()}
    told = [
        f"live shaping, by {TOOL} {block.version}",
        f"request sha256 {block.sha256}",
        *(
            line.replace("in LREAL", "in double").replace("in REAL", "in float")
            for line in block.remarks("LREAL", "REAL")
        ),
    ]
    top = ("\n   ".join(told) + f"\n\n{CALL.substitute(given)}").replace("*/", "* /")
    parts = (BOUNDS, STATE, FLOW, PLAN, SOLVE, WAIT, REPLAN, STEP)
    return "".join([
        f"/* {top} */\n#ifndef {guard}\n#define {guard}\n\n#include <math.h>\n\n{REAL}",
        f"{WAVES}\n{_drive(block)}",
        *(part.substitute(given) for part in parts),
        "#endif\n",
    ])


def _cable(block: LiveBlock) -> dict[str, str]:
    """Return what a block does with a cable length, or without one."""
    if not isinstance(block.plant, Pendulum):
        return {
            "FREQUENCY": literal(block.plant.natural_frequency_rad_s),
            "LENGTH": "",
            "LENGTHINPUT": "",
            "TAKE": TAKE_NO_LENGTH.replace("$NAME", block.name),
            "SEEN": "    shaper->valid = 1;\n",
        }
    shortest, longest = map(literal, block.cable_length_m)
    given = {"NAME": block.name, "SHORTEST": shortest, "LONGEST": longest}
    return {
        "FREQUENCY": f"SHAPERSMITH_SQRT({literal(block.plant.gravity_m_s2)} / length_m)",
        "LENGTH": "cable_length_m, ",
        "LENGTHINPUT": " shapersmith_real cable_length_m,",
        "TAKE": TAKE_LENGTH.substitute(given),
        "SEEN": SEEN_LENGTH.substitute(given),
    }


def _drive(block: LiveBlock) -> str:
    """Return what is known of the lags of a drive."""
    names = list(block.of_lags) if block.order > 1 else ["first_s", "second_s2"]
    return "".join(
        f"static const shapersmith_real {block.name}_{what}[2] = "
        f"{{{', '.join(map(literal, block.of_lags[what]))}}};\n"
        for what in names
    )
