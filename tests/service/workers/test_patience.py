"""Who may wait, and for how long; no process, no clock."""

import pytest

from service.workers.patience import BURST_S, INTERVAL_S, STANDING_S, Patience


def admit(
    rate: float, clients: int | None, seconds: float, server_s: float = 0.002
) -> tuple[list[float], int]:
    """Play arrivals at one server; return the waits of who was admitted, and how many were not.

    ``clients``: how many wait for their answer before they ask again; None for any number.
    """
    patience, now, free_at, waits, refused = Patience(), 0.0, 0.0, [], 0
    ends: list[float] = []
    asking = [0.0] * clients if clients is not None else []
    while now < seconds:
        now = min(asking) if clients is not None else now + 1 / rate
        for end in [end for end in ends if end <= now]:
            patience.count_answer(end)
            ends.remove(end)
        if clients is not None:
            asking.remove(now)
        wait_s = max(free_at - now, 0.0)
        if patience.admits(now, wait_s, server_s):
            waits.append(wait_s)
            free_at = max(free_at, now) + server_s
            ends.append(free_at)
            if clients is not None:
                asking.append(free_at)
        else:
            refused += 1
            if clients is not None:
                asking.append(now + 1.0)  # as Retry-After says
    return waits, refused


@pytest.mark.parametrize("load", [1.5, 3.0, 10.0])
def test_under_a_lasting_overload_what_is_served_is_served_soon(load: float) -> None:
    waits, refused = admit(load * 500, None, 60.0)
    assert sorted(waits)[int(0.99 * len(waits))] <= STANDING_S + 0.002
    assert len(waits) >= 0.99 * 60 * 500
    assert refused == pytest.approx((load - 1) * 500 * 60, rel=0.02)


@pytest.mark.parametrize("clients", [1, 8, 32, 64, 120])
def test_clients_that_wait_for_their_answers_are_not_refused(clients: int) -> None:
    waits, refused = admit(0.0, clients, 20.0)
    assert refused == 0
    assert max(waits) <= BURST_S


def test_clients_that_begin_one_after_another_and_ask_again_at_once_are_no_overload() -> None:
    patience, answered, now = Patience(), 0, 0.0
    for step in range(4000):
        now += 0.001
        arriving = 1 if step < 32 or step % 2 else 0  # 32 clients, then one a free server
        for _ in range(arriving):
            assert patience.admits(now, 0.055, 0.002)
            assert not patience.refuses(now, 0.055, 0.002)
        if step % 2:
            patience.count_answer(now)
            answered += 1
    assert answered == 2000


def test_a_burst_is_served_and_forgotten() -> None:
    patience = Patience()
    waits = [0.002 * number for number in range(120)]
    assert all(patience.admits(0.0, wait_s, 0.002) for wait_s in waits)
    assert not patience.admits(0.0, BURST_S + 0.01, 0.002)
    later = 20 * INTERVAL_S
    assert patience.admits(later, 0.0, 0.002)
    assert patience.admits(later + INTERVAL_S, BURST_S, 0.002)


def test_a_request_that_takes_long_may_wait_longer() -> None:
    assert Patience().admits(0.0, 1.5, 0.2)
    assert not Patience().admits(0.0, 1.5, 0.02)
