"""Whether answers are the same to the byte as those of another state of the code.

    python -m tests.acceptance.same_answers before.txt             # writes a line an answer
    python -m tests.acceptance.same_answers after.txt --count 500
    diff before.txt after.txt

A line is a route, a number and the SHA-256 of the answer, or of the problem document. Asked are the
examples of the catalogue, a table of a thousand rows in each format, and random requests of every
route. For a step that moves code and changes no behaviour.
"""

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from design.export.registry import EXPORTS
from design.shapers.registry import SHAPERS
from service.catalogue import shaper_catalogue
from service.dispatch import answer
from service.problems import Problem
from tests.acceptance.answer_cases import random_shaper, random_subject
from tests.acceptance.random_moves import random_move
from tests.acceptance.random_recommendations import random_recommendation
from tests.acceptance.random_simulations import random_simulation

JSON = dict[str, Any]

TABLE: JSON = {
    "title": "same",
    "design": {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.02},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "zvd"},
    },
    "axes": [
        {
            "field": "/plant/natural_frequency_rad_s",
            "from": 2.0,
            "to": 30.0,
            "points": 1000,
            "spacing": "geometric",
        }
    ],
    "columns": ["times_s", "amplitudes", "residual"],
    "chunk_rows": 300,
}

QUANTITIES = ("residual", "times_s", "duration_s")


def random_design(rng: np.random.Generator) -> JSON:
    """Draw a design of any kind for one mode."""
    names = sorted(SHAPERS)
    name = names[int(rng.integers(len(names)))]
    mode, _, told = random_subject(rng, SHAPERS[name].actuators)
    request: JSON = {**told, "shaper": random_shaper(rng, name)}
    if rng.random() < 0.2:
        request["shaper"]["sample_time_s"] = float(mode.period_s / rng.uniform(20, 200))
    if rng.random() < 0.3:
        request["sensitivity"] = {"from_ratio": 0.7, "to_ratio": 1.3, "points": 31}
    return request


def random_sensitivity(rng: np.random.Generator) -> JSON:
    """Draw a curve of any impulses."""
    mode, _, told = random_subject(rng, ("ideal", "first_order", "second_order", "rate_limited"))
    count = int(rng.integers(2, 8))
    times = np.concatenate(([0.0], np.cumsum(mode.period_s * rng.uniform(0.05, 1.0, count - 1))))
    impulses = {"times_s": times.tolist(), "amplitudes": rng.normal(size=count).tolist()}
    return {**told, "impulses": impulses}


def random_fit(rng: np.random.Generator) -> JSON:
    """Draw curve coefficients over the damping ratio."""
    names = sorted(
        name for name, kind in SHAPERS.items() if not (kind.serves_several or kind.large_swings)
    )
    name = names[int(rng.integers(len(names)))]
    _, _, told = random_subject(rng, SHAPERS[name].actuators)
    end = float(rng.uniform(0.01, 0.2))
    over = {"over": "/plant/damping_ratio", "from": 0.0, "to": end}
    return {**told, "shaper": {"kind": name}, "fit": {**over, "degree": int(rng.integers(1, 4))}}


def random_map(rng: np.random.Generator) -> JSON:
    """Draw a map of few cells."""
    names = sorted(
        name for name, kind in SHAPERS.items() if not (kind.serves_several or kind.large_swings)
    )
    name = names[int(rng.integers(len(names)))]
    _, _, told = random_subject(rng, SHAPERS[name].actuators)
    request: JSON = {**told, "shaper": {"kind": name}}
    request["x"] = {"field": "/plant/damping_ratio", "from": 0.0, "to": 0.1, "points": 3}
    request["quantity"] = QUANTITIES[int(rng.integers(len(QUANTITIES)))]
    if request["quantity"] != "residual" or rng.random() < 0.3:
        request["design"] = "each"
    return request


def random_requests() -> dict[str, Callable[[np.random.Generator], JSON]]:
    """Return what draws a request of each route."""
    return {
        "design": random_design,
        "sensitivity": random_sensitivity,
        "fit": random_fit,
        "maneuver": lambda rng: random_move(rng)[1],
        "simulation": lambda rng: random_simulation(rng)[1],
        "map": random_map,
        "recommendation": lambda rng: random_recommendation(rng)[1],
    }


def hash_answer(operation: str, request: JSON) -> str:
    """Return the hash of an answer."""
    outcome = answer(operation, json.dumps(request).encode()).outcome
    if isinstance(outcome, Problem):
        outcome = outcome.document().model_dump_json().encode()
    return hashlib.sha256(outcome).hexdigest()


def lines(count: int) -> Iterator[str]:
    """Yield a line an answer."""
    catalogue = shaper_catalogue()
    yield f"catalogue 0 {hashlib.sha256(catalogue.model_dump_json().encode()).hexdigest()}"
    for number, entry in enumerate(catalogue.shapers):
        yield f"example {number} {hash_answer('design', entry.example)}"
    with tempfile.TemporaryDirectory() as folder:
        specification = Path(folder) / "table.json"
        specification.write_text(json.dumps(TABLE))
        for name in EXPORTS:
            path = Path(folder) / f"out.{name}"
            command = [sys.executable, "-m", "service", "table", str(specification)]
            done = subprocess.run(
                [*command, "-o", str(path), "--format", name], capture_output=True, check=False
            )
            content = path.read_bytes() if done.returncode == 0 else done.stderr
            yield f"table {name} {hashlib.sha256(content).hexdigest()}"
    for order, (operation, draw) in enumerate(random_requests().items()):
        for number in range(count):
            request = draw(np.random.default_rng([order, number]))
            yield f"{operation} {number} {hash_answer(operation, request)}"


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path)
    parser.add_argument("--count", type=int, default=500)
    given = parser.parse_args()
    with given.output.open("w") as file:
        for line in lines(given.count):
            file.write(f"{line}\n")
            file.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
