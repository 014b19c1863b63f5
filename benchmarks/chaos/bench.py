"""How fast it is: the same as `python -m benchmarks http`."""

from collections.abc import Iterator

from benchmarks import http
from benchmarks.chaos.trial import Trial
from benchmarks.measure import Figure


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    del trial
    yield from http.figures()
