"""Every kind of shaper. One more: write its file, then list it here (CONTRIBUTING.md)."""

from design.shapers.ei import EI, THREE_HUMP_EI, TWO_HUMP_EI, UM_2EI, UM_EI
from design.shapers.kind import ShaperKind
from design.shapers.multi_si import MULTI_SI
from design.shapers.negative import SNA_ZV, SNA_ZVD
from design.shapers.num_large import NUM_LARGE
from design.shapers.num_multi import NUM_MULTI
from design.shapers.numei import NUM_2EI, NUM_EI
from design.shapers.numsi import NUM_SI
from design.shapers.numzv import NUMZV, UMZVC
from design.shapers.numzvd import NUMZVD
from design.shapers.partial_sums import PS_ZV, PS_ZVD
from design.shapers.positive import MZV, ZV, ZVD, ZVDD, ZVDDD
from design.shapers.several_modes import CONVOLVED, MULTI_UMZV, MULTI_ZV
from design.shapers.specified_insensitivity import SI
from design.shapers.umzv import UMZV, UMZVD

POSITIVE = (ZV, ZVD, ZVDD, ZVDDD, MZV, EI, TWO_HUMP_EI, THREE_HUMP_EI)
UNITY = (UMZV, UMZVD, UM_EI, UM_2EI, UMZVC, NUMZV, NUMZVD, NUM_EI, NUM_2EI, NUM_SI)
NEGATIVE = (PS_ZV, PS_ZVD, SNA_ZV, SNA_ZVD)
FOR_SEVERAL_MODES = (MULTI_ZV, MULTI_UMZV, NUM_MULTI, MULTI_SI, CONVOLVED)

OVER_A_BAND = (SI,)
LARGE_SWINGS = (NUM_LARGE,)

SHAPERS: dict[str, ShaperKind] = {
    kind.name: kind
    for kind in (
        *POSITIVE,
        *UNITY,
        *NEGATIVE,
        *OVER_A_BAND,
        *FOR_SEVERAL_MODES,
        *LARGE_SWINGS,
    )
}
