"""Who is next, who may wait, and what work is expected to cost: no process, no clock."""

import random
from collections import Counter

import pytest

from service.workers.costs import FIRST_GUESS_S, MAX_SHAPES, SLICE_S, Costs
from service.workers.patience import BURST_S, INTERVAL_S, STANDING_S, Patience
from service.workers.queue import FairQueue, Flow, Ticket
from service.workers.shapes import MAX_SHAPE_BYTES, shape_of


def add(queue: FairQueue, flow: Flow, cost_s: float = 0.01) -> Ticket:
    ticket = Ticket(flow, cost_s)
    queue.add(ticket)
    return ticket


def serve(queue: FairQueue) -> list[Ticket]:
    found = []
    while (ticket := queue.pop()) is not None:
        found.append(ticket)
    return found


def test_one_flow_is_served_first_come_first_served() -> None:
    queue = FairQueue()
    tickets = [add(queue, Flow("a"), random.Random(1).random()) for _ in range(100)]
    assert serve(queue) == tickets


def test_one_flow_keeps_its_order_when_it_is_charged_less_or_more_than_expected() -> None:
    rng = random.Random(2)
    queue, tickets, found = FairQueue(), [], []
    for _ in range(500):
        tickets.append(add(queue, Flow("a"), rng.random()))
        if rng.random() < 0.8 and (ticket := queue.pop()) is not None:
            found.append(ticket)
            queue.charge(ticket, rng.random())
    assert found + serve(queue) == tickets


def test_who_comes_late_does_not_wait_for_all_that_another_has_queued() -> None:
    queue = FairQueue()
    heavy = [add(queue, Flow("heavy")) for _ in range(256)]
    assert queue.pop() is heavy[0]
    late = add(queue, Flow("late"))
    assert queue.pop() in {late, heavy[1]}
    assert late.waiting is False or queue.pop() is late


@pytest.mark.parametrize("seed", range(20))
def test_clients_that_always_wait_get_equal_shares_of_time_whatever_their_work_costs(
    seed: int,
) -> None:
    rng = random.Random(seed)
    queue = FairQueue()
    costs = {Flow(str(number)): rng.uniform(0.001, 0.2) for number in range(4)}
    expected = {flow: rng.uniform(0.001, 0.2) for flow in costs}  # wrong, until it is charged
    for flow, cost_s in expected.items():
        add(queue, flow, cost_s)
        add(queue, flow, cost_s)
    spent: Counter[Flow] = Counter()
    for _ in range(4000):
        ticket = queue.pop()
        assert ticket is not None
        queue.charge(ticket, costs[ticket.flow])
        spent[ticket.flow] += costs[ticket.flow]  # type: ignore[assignment]
        add(queue, ticket.flow, expected[ticket.flow])
    least, most = min(spent.values()), max(spent.values())
    assert most - least <= 10 * max(*costs.values(), *expected.values())


def test_a_batch_yields_to_single_requests_and_is_not_starved() -> None:
    queue = FairQueue()
    for _ in range(100):
        add(queue, Flow("a", "batch"))
        add(queue, Flow("a", "single"))
    first = Counter(queue.pop().flow.kind for _ in range(50))  # type: ignore[union-attr]
    assert first["single"] == pytest.approx(40, abs=2)
    assert first["batch"] >= 8


def test_what_is_small_does_not_wait_for_what_is_large_of_the_same_client() -> None:
    queue = FairQueue()
    for _ in range(50):
        add(queue, Flow("a", large=True), 0.2)
    queue.pop()
    small = add(queue, Flow("a"), 0.002)
    assert queue.wait_s(Flow("a"), 0.002, 1) < 0.01
    assert small in {queue.pop(), queue.pop()}


def test_tickets_taken_out_are_not_served_and_leave_nothing_behind() -> None:
    queue = FairQueue()
    rng = random.Random(3)
    tickets = [add(queue, Flow(str(rng.randrange(5)))) for _ in range(200)]
    gone = rng.sample(tickets, 120)
    for ticket in gone:
        queue.remove(ticket)
        queue.remove(ticket)
    assert len(queue) == 80
    assert set(serve(queue)) == set(tickets) - set(gone)
    assert (len(queue), queue.wait_s(Flow("b"), 1.0, 1)) == (0, 0.0)
    assert list(queue) == []


def test_tickets_taken_out_cost_nothing() -> None:
    queue = FairQueue()
    gone = [add(queue, Flow("a"), 20.0) for _ in range(5)]
    add(queue, Flow("b"), 1.0)
    for ticket in gone:
        queue.remove(ticket)
    others = [add(queue, Flow("b"), 1.0) for _ in range(50)]
    mine = add(queue, Flow("a"), 1.0)
    assert mine in serve(queue)[:3]
    assert others


def test_nothing_is_kept_of_clients_that_have_left() -> None:
    queue = FairQueue()
    for number in range(1000):
        ticket = add(queue, Flow(str(number)))
        assert queue.pop() is ticket
        queue.charge(ticket, 0.5)
    assert not queue._finish


def test_a_ticket_put_back_is_served_before_those_that_came_later() -> None:
    queue = FairQueue()
    first, second = add(queue, Flow("a")), add(queue, Flow("a"))
    assert queue.pop() is first
    again = Ticket(first.flow, first.cost_s)
    queue.add(again, first.start)
    assert serve(queue) == [again, second]


def test_the_expected_wait_is_that_of_a_simulation() -> None:
    for seed in range(50):
        rng = random.Random(seed)
        queue = FairQueue()
        for _ in range(rng.randrange(1, 200)):
            add(queue, Flow(str(rng.randrange(4))), 0.01)
        flow = Flow(str(rng.randrange(6)))
        told_s = queue.wait_s(flow, 0.01, 1)
        mine = add(queue, flow, 0.01)
        before = 0
        while queue.pop() is not mine:
            before += 1
        # A flow of fewer tickets than its share ends early: the others go faster then.
        assert 0.01 * before <= told_s + 0.01 * 4


def test_work_that_differs_in_numbers_only_is_expected_to_cost_alike() -> None:
    bodies = [b'{"plant": {"cable_length_m": 0.8}}', b'{"plant": {"cable_length_m": -1.2e-3}}']
    one, other = (shape_of("design", body) for body in bodies)
    assert one == other
    assert one != shape_of("map", bodies[0])
    assert one != shape_of("design", bodies[0].replace(b"cable", b"other"))
    assert shape_of("design", b"1" * MAX_SHAPE_BYTES + b"22") == ("design", 15)


def test_costs_are_learned_and_forgotten() -> None:
    costs = Costs()
    assert costs.of("a", "new") == FIRST_GUESS_S
    for _ in range(50):
        costs.record("a", "slow", 20.0)
        costs.record("a", "quick", 0.002)
    assert costs.of("b", "slow") == pytest.approx(20.0)
    assert costs.of("b", "quick") == pytest.approx(0.002)
    assert costs.of("b", "new") == pytest.approx(0.002, rel=0.01)
    for number in range(MAX_SHAPES):
        costs.record("a", number, 1.0)
    assert costs.of("b", "slow") == costs.of("b", "new")


def test_what_runs_long_is_expected_of_its_client_alone_and_unlearned() -> None:
    costs = Costs()
    for _ in range(20):
        costs.record("a", "map", 0.002)
    costs.at_least("a", "map", 3.0)
    costs.record("a", "map", 20.0)
    assert costs.of("a", "map") > SLICE_S
    assert costs.of("b", "map") < SLICE_S
    for _ in range(20):
        costs.record("a", "map", 0.002)
    assert costs.of("a", "map") < 0.01


def test_what_waits_for_something_makes_no_machine_slow() -> None:
    costs = Costs()
    for number in range(100):
        costs.took(5.0 if number % 25 == 0 else 0.004, 0.003)
    for _ in range(20):
        costs.took(0.004, 0.003)
    assert costs.slowness < 3.0


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
