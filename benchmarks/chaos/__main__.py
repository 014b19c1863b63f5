"""Do all parts, or those that are named, and print the report; exit 1 if a limit is missed."""

import argparse
import gc
import importlib
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator

from benchmarks.chaos.trial import Trial
from benchmarks.measure import Figure

PARTS = ("fair", "overload", "neighbour", "kills", "blocked", "tables", "bench")


def main() -> int:
    """Return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.chaos", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--seconds", type=float, help="at most so long at a time, for a trial")
    parser.add_argument("--times", type=int, default=100, help="kills of each sort; 100 if not")
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"there is no part {', '.join(sorted(unknown))}")
    # Whoever ends this ends the services that it started.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    gc.disable()  # a collection among a hundred thousand outcomes would count as the service's
    trial = Trial(seconds=options.seconds, times=options.times)
    missed = 0
    for part in options.parts or PARTS:
        print(f"\n{part}: load of the machine {os.getloadavg()[0]:.2f} at its start", flush=True)
        wall_s, used_s = time.perf_counter(), time.process_time()
        figures: Callable[[Trial], Iterator[Figure]] = importlib.import_module(
            f"benchmarks.chaos.{part}"
        ).figures
        for figure in figures(trial):
            met = {True: "met", False: "MISSED", None: ""}[figure.met]
            limit = f"({figure.limit}) " if figure.limit else ""
            print(f"{figure.what}: {figure.value} {limit}{met}", flush=True)
            missed += figure.met is False
        wall_s, used_s = time.perf_counter() - wall_s, time.process_time() - used_s
        print(
            f"{part}: took {wall_s:.0f} s; the client {100 * used_s / wall_s:.0f} % of a processor"
        )
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
