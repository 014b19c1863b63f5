"""The first of the random answers on samples; `tests.acceptance.random_answers` runs more."""

from typing import Any

import pytest

from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from tests.acceptance.random_answers import verdict
from tests.acceptance.random_kinds import report
from tests.acceptance.sample_judges import wrong_refusal
from tests.acceptance.test_random_answers import answers

COUNTS = {"samples": 120, "programs": 80}

MOST_REFUSED = {"samples": 0.25, "programs": 0.1}
"""Shares that may be refused: mostly shapers that do not exist between the samples either [-]."""


@pytest.mark.parametrize("what", COUNTS)
def test_random_answers_on_samples_are_what_another_route_finds(what: str) -> None:
    found = [verdict(what, number) for number in range(COUNTS[what])]
    assert not any(one.wrong for one in found), "\n".join(report(found))
    assert sum(bool(one.refusal) for one in found) <= MOST_REFUSED[what] * len(found)


@pytest.mark.parametrize("spoilt", ["residual", "amplitudes", "bound", "samples", "warnings"])
def test_an_answer_on_samples_that_is_not_what_it_says_is_told(spoilt: str) -> None:
    caught = 0
    for answer, faults in answers("samples", 25):
        assert list(faults(answer)) == []
        same = not _spoil(answer, spoilt)
        caught += not same
        assert same or list(faults(answer)), spoilt
    assert caught >= 3


def test_a_proof_that_is_none_is_told() -> None:
    plant = Mode(natural_frequency_rad_s=24.619954, damping_ratio=0.027151800)
    words = (
        "no command of level 0 or 1 on samples of 0.0970259 s was found whose residual over the "
        "band of 0.8847 to 1.111 is less than that of an unshaped step; proven: no command of up "
        "to 7 samples has less than {} %: take a shorter sample time"
    )
    told = [
        list(wrong_refusal(words.format(figure), plant, Ideal(), 0.09702593))
        for figure in (90.0, 130.0)
    ]
    assert (told[0], len(told[1])) == ([], 1)


def _spoil(answer: Any, what: str) -> bool:
    """Spoil an answer; return whether it is then wrong."""
    sampled, amplitudes = answer["sampled"], answer["shaper"]["impulses"]["amplitudes"]
    if what == "residual":
        answer[what] += 1e-6
    elif what == "amplitudes":
        amplitudes[0], amplitudes[-1] = amplitudes[0] + 1e-7, amplitudes[-1] - 1e-7
    elif what == "bound":
        claims = answer["certificate"]["claims"]
        if sampled["bound"] is None or sampled["method"] != "free_amplitudes":
            return False
        sampled["bound"] = 2 * max(one["value"] for one in claims) + 1e-6
    elif what == "samples":
        sampled[what][-1] += 1
    else:
        told = {"tolerance_not_kept", "actuator_ignored"}
        wrong = bool(told & {one["code"] for one in answer[what]})
        answer[what] = []
        return wrong
    return True
