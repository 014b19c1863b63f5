"""Random answers of several operations through the wire, each played by another route.

    python -m tests.acceptance.random_answers moves 5000
    python -m tests.acceptance.random_answers simulations 2000
    python -m tests.acceptance.random_answers recommendations 500
    python -m tests.acceptance.random_answers samples 5000
    python -m tests.acceptance.random_answers programs 2000

Requests go in and answers come out as JSON, as over HTTP. What an answer says of the drive given,
its residual, distance, claims and warnings, is held against `tests.expm_route`. The report counts
answers, refusals by reason and the slowest; the exit status is 1 if anything is wrong. The suite
runs the first of them.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from service.dispatch import respond
from service.problems import INFEASIBLE, INVALID, Problem
from tests.acceptance.random_kinds import Verdict, report
from tests.acceptance.random_moves import random_move, random_program
from tests.acceptance.random_recommendations import random_recommendation
from tests.acceptance.random_samples import random_design_on_samples
from tests.acceptance.random_simulations import random_simulation

OPERATIONS = {
    "moves": ("maneuver", random_move),
    "recommendations": ("recommendation", random_recommendation),
    "simulations": ("simulation", random_simulation),
    "samples": ("design", random_design_on_samples),
    "programs": ("maneuver", random_program),
}
"""Operations by what is drawn; a new one is last, as its place seeds its cases."""


PROOF = "proven: no command"
"""What a refusal says of every command of its horizon."""


def generator(what: str, number: int) -> np.random.Generator:
    """Return what draws a case, the same in every run."""
    return np.random.default_rng([list(OPERATIONS).index(what), number])


def verdict(what: str, number: int) -> Verdict:
    """Ask for one answer and judge it."""
    operation, drawn = OPERATIONS[what]
    name, request, judge = drawn(generator(what, number))
    faults: Callable[[Any], Iterator[str]] = judge
    refusal = ""
    wrong: list[str] = []
    asks_for_none = False
    started = time.process_time()
    try:
        answer = respond(operation, json.dumps(request).encode())
        seconds = time.process_time() - started
        if not isinstance(answer, Problem):
            wrong += faults(json.loads(answer.model_dump_json(by_alias=True)))
        elif answer.kind in {INVALID, INFEASIBLE}:
            refusal = f"{answer.code}: {answer.detail}"
            asks_for_none = answer.kind is INVALID or answer.code == "pulse_goes_nowhere"
            wrong += faults(answer) if what == "samples" else []
        else:
            wrong.append(f"{answer.kind.name}: {answer.detail}")
    except Exception as error:  # noqa: BLE001 - whatever it is, it is reported
        seconds = time.process_time() - started
        wrong.append(f"{type(error).__name__}: {error}")
    label = f"{name} {request['actuator']['kind']}"
    return Verdict(
        number=number,
        kind=label,
        refusal=refusal,
        wrong=tuple(wrong),
        seconds=seconds,
        asks_for_none=asks_for_none,
        proves=PROOF in refusal,
    )


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=list(OPERATIONS))
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    found = []
    for number in range(given.first, given.first + given.count):
        found.append(verdict(given.what, number))
        for text in found[-1].wrong:
            print(f"case {number}, {found[-1].kind}: {text}", file=sys.stderr, flush=True)
    print("\n".join(report(found)))
    refused = sum(bool(one.refusal) for one in found)
    none = sum(one.asks_for_none for one in found)
    proven = sum(one.proves and not one.asks_for_none for one in found)
    share = 1 - (refused - none - proven) / max(len(found) - none, 1)
    print(
        f"{len(found)} {given.what}, {refused} refused, {none} of them for what they ask, {proven} "
        f"with a proof; of what asks for something {100 * share:.2f} % answered or proven none"
    )
    return int(any(one.wrong for one in found))


if __name__ == "__main__":
    sys.exit(main())
