"""A thousand random strings of events, each at rest with what is left of it told."""

import math

from design.live.emergency_request import EmergencyRequest
from design.live.session import LiveState
from tests.acceptance.live_strings import played, random_strings, swing_left

STRINGS = 1000
FALLBACKS = 0.02
"""Share of the events at which an older plan may go on [-]."""

OF_RIG = 1e-7
"""What its integration adds to a swing [-]."""


def _told(state: LiveState) -> float:
    assert state.certificate is not None
    return max(one.value for one in state.certificate.claims if one.quantity == "residual")


def test_a_thousand_strings_end_at_rest_within_range_with_what_is_left_told() -> None:
    events = fallbacks = 0
    for machine, string in random_strings(STRINGS):
        states, sent = played(machine, string)
        events += len(states)
        for state, (_, request) in zip(states, string, strict=True):
            assert state.certificate is not None
            if state.fallback is not None:
                fallbacks += 1
            elif isinstance(request, EmergencyRequest):
                assert _told(state) <= request.swing_left + 1e-9
            else:
                assert state.certificate.verified
        assert all(abs(level) <= 1.0 for one in sent.values() for _, level in one)
        # Each axis swings by what is told at most, and the crane by both together.
        told = math.sqrt(2) * _told(states[-1])
        assert swing_left(machine, string, sent) <= told * (1 + 1e-6) + OF_RIG
    assert fallbacks <= FALLBACKS * events
