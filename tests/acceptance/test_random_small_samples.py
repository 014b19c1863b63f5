"""Of few samples, no cone program and no listing finds a shorter shaper, or leaves less."""

from itertools import count

from tests.acceptance.random_small_samples import MOST_SAMPLES, beaten, compared, drawn


def test_no_other_way_is_better() -> None:
    ways, found = beaten(count(10_000), 16)
    assert found == []
    assert set(ways) == {"cone program", "listing"}


def test_a_sample_too_many_is_told() -> None:
    told = 0
    for number in range(10_000, 10_060):
        judge = drawn(number)
        if judge is None or not compared(judge).way or compared(judge).beaten:
            continue
        samples = judge.answer["sampled"]["samples"]
        if samples[-1] + 2 <= MOST_SAMPLES:
            samples[-1] += 1
            told += "one less" in compared(judge).beaten
    assert told >= 3
