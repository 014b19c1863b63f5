"""How much a search may do: counted work, never a clock, so that equal requests end alike.

Work is counted in units of about a microsecond of a core of 2020 or so. Each solver counts what it
does, evaluations, iterations, programs, by their size and constants that are measured.
"""

from dataclasses import dataclass

from design.trace import TraceStep

MAX_WORK_PER_DESIGN = 4_000_000
"""What the search for one design may take [units]."""


@dataclass(slots=True)
class Budget:
    """What a search may do yet."""

    most: float = MAX_WORK_PER_DESIGN  # Work that it may do in all [units]
    done: float = 0.0  # Work that it has done [units]
    # Steps of the search, in order, of one that is watched; None of others
    trace: list[TraceStep] | None = None

    def spend(self, work: float) -> None:
        """Count some work, done or about to be."""
        self.done += work

    @property
    def spent(self) -> bool:
        """Whether nothing is left: a search then ends with the best that it has."""
        return self.done >= self.most

    def part(self, most: float) -> "Budget":
        """Return a budget of a part of what is left, at most so much work [units].

        The part counts its own work. The caller spends that work here too.
        """
        return Budget(most=min(most, max(self.most - self.done, 0.0)), trace=self.trace)

    def note(self, step: TraceStep) -> None:
        """Keep a step of a search that is watched."""
        if self.trace is not None:
            self.trace.append(step)

    @property
    def in_words(self) -> str:
        """What a refusal says of a search that ended for this."""
        return f"its budget of {self.most / 1e6:.3g} million units of work is spent"
