"""How the two sets of an actuator share it."""

from typing import Literal

Model = Literal["superposed", "switched"]
"""How the two sets share the actuator.

``superposed``: each step excites a separate response, by its own set (Kim 2011, 3.23-3.26).
``switched``: one actuator, whose state carries over; the set in force is that of the latest change
of the command's magnitude (Kim 2011, 4.2-4.8 and 4.23-4.28).
"""
