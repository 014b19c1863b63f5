"""Random designs of every kind: each verified by a second route, or refused for a true reason.

    python -m tests.acceptance.random_kinds 20000 --workers 1

designs as many cases of `tests.random_cases`, prints counts, refusals by reason and the slowest,
and exits 1 if anything is wrong. ``--first n`` begins at another case, ``--longest-s`` ends early.
The suite runs the first of them.
"""

import argparse
import multiprocessing
import re
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from design.errors import InfeasibleDesignError, InvalidInputError
from design.pipeline import design
from design.solvers.budget import Budget
from tests.acceptance.judges import wrong_in_design
from tests.acceptance.refusal_judges import wrong_in_refusal
from tests.random_cases import case

MAX_DESIGN_S = 5.0
"""Processor time of a design, at most, as the command tells it; the suite counts work [s]."""

OVERSHOOT = 1_000_000
"""What the last step of a search may take beyond its budget [units]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What became of a case.

    Attributes
    ----------
    number, kind
        Which case it was.
    refusal
        Why it was refused; empty if it was designed.
    wrong
        What is wrong with the answer, or with the reason.
    seconds
        Processor time of the design [s].
    asks_for_none
        Whether what is asked for is none: a value beyond its bound, a pulse that goes nowhere.
    proves
        Whether the refusal holds a proof that no command of the horizon serves.
    """

    number: int
    kind: str
    refusal: str
    wrong: tuple[str, ...]
    seconds: float
    asks_for_none: bool = False
    proves: bool = False


def verdict(number: int) -> Verdict:
    """Design a case and judge the answer."""
    subject = case(number)
    refusal, wrong, budget = "", [], Budget()
    started = time.process_time()
    try:
        made = design(subject.plant, subject.actuator, subject.kind, subject.options, budget)
    except (InfeasibleDesignError, InvalidInputError) as error:
        refusal = str(error)
    except Exception as error:  # noqa: BLE001 - whatever it is, it is reported
        wrong.append(f"{type(error).__name__}: {error}")
    seconds = time.process_time() - started
    if budget.done > budget.most + OVERSHOOT:
        wrong.append(f"did {budget.done:.3g} units of work")
    try:
        if refusal:
            wrong += wrong_in_refusal(subject, refusal)
        elif not wrong:
            wrong += wrong_in_design(subject, made)
    except Exception as error:  # noqa: BLE001 - one that comes with another design than this
        wrong.append(f"while it was judged, {type(error).__name__}: {error}; told: {refusal}")
    return Verdict(
        number=number,
        kind=subject.kind.name,
        refusal=refusal,
        wrong=tuple(wrong),
        seconds=seconds,
    )


def verdicts(numbers: Iterable[int], workers: int = 1) -> Iterator[Verdict]:
    """Yield verdicts in order, from that many processes."""
    if workers == 1:
        yield from map(verdict, numbers)
        return
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        yield from pool.imap(verdict, numbers, chunksize=20)


def reason(refusal: str) -> str:
    """Return a refusal without its numbers."""
    return re.sub(r"-?\d+(\.\d+)?(e[+-]?\d+)?", "#", refusal)[:110]


def report(found: list[Verdict]) -> Iterator[str]:
    """Yield the lines of a report."""
    by_kind: defaultdict[str, list[Verdict]] = defaultdict(list)
    for one in found:
        by_kind[one.kind].append(one)
    yield "kind             cases verified refused wrong  median, longest [ms]"
    for kind, own in by_kind.items():
        refused = sum(bool(one.refusal) for one in own)
        wrong = sum(bool(one.wrong) for one in own)
        times = sorted(1e3 * one.seconds for one in own)
        yield (
            f"{kind:15} {len(own):6} {len(own) - refused - wrong:8} {refused:7} {wrong:5}  "
            f"{times[len(times) // 2]:.1f}, {times[-1]:.0f}"
        )
    reasons = Counter(f"{one.kind}: {reason(one.refusal)}" for one in found if one.refusal)
    for text, count in reasons.most_common():
        yield f"{count:6} {text}"
    for one in sorted(found, key=lambda one: -one.seconds)[:10]:
        yield f"slow: case {one.number}, {one.kind}, {one.seconds:.2f} s {one.refusal[:60]}"
    for one in found:
        for text in one.wrong:
            yield f"WRONG: case {one.number}, {one.kind}: {text}"


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--longest-s", type=float, default=7200.0, help="reports what is done then")
    given = parser.parse_args()
    found = []
    end = time.monotonic() + given.longest_s
    for told in verdicts(range(given.first, given.first + given.count), given.workers):
        one = told
        if told.seconds > MAX_DESIGN_S:
            one = replace(told, wrong=(*told.wrong, f"took {told.seconds:.1f} s"))
        found.append(one)
        for text in one.wrong:
            print(f"case {one.number}, {one.kind}: {text}", file=sys.stderr, flush=True)
        if len(found) % 1000 == 0:
            print(f"{len(found)} cases", file=sys.stderr, flush=True)
        if time.monotonic() > end:
            break
    print(f"{len(found)} of {given.count} cases")
    print("\n".join(report(found)))
    return int(any(one.wrong for one in found))


if __name__ == "__main__":
    sys.exit(main())
