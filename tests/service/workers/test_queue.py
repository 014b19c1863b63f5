"""Who is next: fair between clients and between small and large work; no process, no clock."""

import random
from collections import Counter

import pytest

from service.workers.queue import FairQueue, Flow, Ticket


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
