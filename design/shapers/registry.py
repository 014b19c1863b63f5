"""Every kind of shaper. One more: write its file, then list it here (CONTRIBUTING.md)."""

from design.shapers.kind import ShaperKind
from design.shapers.numzv import NUMZV, NUMZVD, UMZVC
from design.shapers.umzv import UMZV, UMZVD

SHAPERS: dict[str, ShaperKind] = {kind.name: kind for kind in (UMZV, UMZVD, UMZVC, NUMZV, NUMZVD)}
