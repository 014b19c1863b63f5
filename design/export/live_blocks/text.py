"""Live shaping as blocks of Structured Text: the last one is called once a cycle, and solves anew.

The blocks do what the functions of C do (`design.export.live_blocks.c`). The algorithm is described
in `design.export.live_blocks.block`.
"""

from string import Template

import numpy as np

from design.export.header import TOOL
from design.export.live_blocks.block import COUNTED, LiveBlock
from design.export.live_blocks.text_lags import FIRST_ORDER, ONE_LAG, SECOND_ORDER, switched_parts
from design.export.live_blocks.text_motion import ANGLE, OVER, PULSE, REMAINS, SWITCH
from design.export.live_blocks.text_replan import REPLAN
from design.export.live_blocks.text_solve import SOLVE
from design.export.live_blocks.text_step import CALL, SHAPER
from design.export.structured_numbers import real, reals
from design.model.plants.pendulum import Pendulum
from design.tables.rows import Real


def live_in_text(block: LiveBlock) -> str:
    """Return live shaping as Structured Text.

    Parameters
    ----------
    block
        The machine.

    Returns
    -------
    str
        A comment, the example of a call, then the function blocks, that of the cycle last.

    Raises
    ------
    InvalidInputError
        If a number is not finite in its type.
    """
    of = block.real
    given = {
        "NAME": block.name,
        "REAL": of,
        "TOREAL": f"DINT_TO_{of}",
        **{key: str(value) for key, value in block.counts.items()},
        **{key: real(value, of) for key, value in block.constants.items()},
        "LASTWAIT": str(block.counts["WAITS"] - 1),
        "LASTEND": str(4 * block.counts["WAITS"] - 1),
        "BOUND": real(COUNTED[of], of),
        "LONGEST": f"{block.longest_cycle_s:.4g}",
        "LONGESTC": real(block.longest_cycle_s, of),
        "CYCLE": real(block.example_cycle_s, of),
        "FIRST": _pair(block.of_lags["first_s"], of),
        "SECOND": _pair(block.of_lags["second_s2"], of),
        **_cable(block),
    }
    parts = {0: ONE_LAG, 1: FIRST_ORDER, 2: SECOND_ORDER}[block.order]
    if block.order:
        parts = parts | switched_parts(block.order)
    given |= {key: Template(text).substitute(given) for key, text in parts.items()}
    told = [
        f"live shaping, by {TOOL} {block.version}",
        f"request sha256 {block.sha256}",
        *block.remarks(of),
    ]
    comment = "\n   ".join(told).replace("*)", "* )").replace("(*", "( *")
    over, solve = OVER.substitute(given), SOLVE.substitute(given)
    if block.order:
        names = list(block.of_lags)
        over = _with_constants(block, over, names[:1] if block.order == 1 else names[2:])
        solve = _with_constants(block, solve, names[: block.order])
    rest = (part.substitute(given) for part in (ANGLE, SWITCH, REMAINS, PULSE))
    return "".join([
        f"(* {comment} *)\n\n",
        CALL.substitute(given),
        "\n\n".join([
            over,
            *rest,
            solve,
            REPLAN.substitute(given),
            SHAPER.substitute(given),
        ]),
        "\n",
    ])


def _pair(values: tuple[float, ...], of: Real) -> str:
    return reals(np.array(values), of)


def _with_constants(block: LiveBlock, text: str, names: list[str]) -> str:
    """Return a block with constants of the drive ahead of its variables."""
    declared = "".join(
        f"    {name} : ARRAY[0..1] OF {block.real} := [\n"
        f"{_pair(block.of_lags[name], block.real)}];\n"
        for name in names
    )
    return text.replace("END_VAR\nVAR\n", f"END_VAR\nVAR CONSTANT\n{declared}END_VAR\nVAR\n", 1)


def _cable(block: LiveBlock) -> dict[str, str]:
    """Return what the block of the cycle does with a cable length, or without one."""
    of = block.real
    if not isinstance(block.plant, Pendulum):
        return {
            "CABLEREMARK": "",
            "CABLEINPUT": "",
            "CABLEOUTPUT": "",
            "CABLECALL": "",
            "CABLESEEN": "",
            "TAKES": "NOT (length_m > 0.0)",
            "LENGTH": "1.0",
            "FREQUENCY": real(block.plant.natural_frequency_rad_s, of),
        }
    shortest, longest = (real(one, of) for one in block.cable_length_m)
    inside = f"cable_length_m >= {shortest} AND cable_length_m <= {longest}"
    return {
        "CABLEREMARK": "valid is TRUE while cable_length_m is one of this crane,\n"
        "   held while another length than it is in use. ",
        "CABLEINPUT": f"    cable_length_m : {of};\n",
        "CABLEOUTPUT": "    valid : BOOL;\n    held : BOOL;\n",
        "CABLECALL": " cable_length_m := cable_length_m,",
        "CABLESEEN": f"valid := {inside};\nheld := NOT (cable_length_m = length_m);\n",
        "TAKES": f"{inside} AND cable_length_m <> length_m",
        "LENGTH": "cable_length_m",
        "FREQUENCY": f"SQRT({real(block.plant.gravity_m_s2, of)} / length_m)",
    }
