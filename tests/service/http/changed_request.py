"""A request with one value changed."""

import copy
from typing import Any

from tests.conftest import CRANE

JSON = {"content-type": "application/json"}
NATURAL = "/actuator/accel/natural_frequency_rad_s"


def changed(pointer: str, value: Any) -> dict[str, Any]:
    """Return the crane with one field set."""
    request = copy.deepcopy(CRANE)
    *path, last = pointer.strip("/").split("/")
    here = request
    for step in path:
        here = here.setdefault(step, {})
    here[last] = value
    return request
