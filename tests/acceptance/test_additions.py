"""A dummy of each kind of addition: its file and its rows make it known everywhere, and no more.

Each is added to a copy of the packages, asked for by the command line and found in the documents of
the wire, and taken out again.
"""

import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("shapersmith", "design", "schemas", "service")

MAX_FILES = 3

CRANE = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8},
    "actuator": {"kind": "ideal"},
    "shaper": {"kind": "zv"},
    "sensitivity": None,
}


@dataclass(frozen=True)
class Addition:
    """What is added: files, rows of files that are there, and what then is to be said where.

    Attributes
    ----------
    files
        Text by path.
    rows
        By path: what is replaced, and by what.
    request
        A design that needs it; None where none does.
    command
        Arguments of a command whose output names it.
    documented
        What `/openapi.json` says of it; nothing where it is no field's value.
    """

    files: dict[str, str]
    rows: dict[str, list[tuple[str, str]]]
    command: tuple[str, ...]
    request: dict[str, object] | None = None
    documented: str = ""


SHAPER = Addition(
    files={
        "design/shapers/dummy.py": """
from dataclasses import replace

from design.shapers.positive import ZV

DUMMY = replace(ZV, name="dummy", summary="A dummy.")
"""
    },
    rows={
        "design/shapers/registry.py": [
            ("OVER_A_BAND = (SI,)", "OVER_A_BAND = (SI, DUMMY)"),
            (
                "from design.shapers.ei import",
                "from design.shapers.dummy import DUMMY\nfrom design.shapers.ei import",
            ),
        ]
    },
    request={**CRANE, "shaper": {"kind": "dummy"}},
    command=("shapers",),
    documented='"const":"dummy"',
)

ACTUATOR = Addition(
    files={
        "design/model/actuators/dummy.py": """
from dataclasses import dataclass
from typing import ClassVar

from design.model.actuators.first_order import FirstOrder


@dataclass(frozen=True, slots=True, kw_only=True)
class Dummy(FirstOrder):
    kind: ClassVar[str] = "dummy"
"""
    },
    rows={
        "design/model/actuators/registry.py": [
            (
                "Actuator = Unlimited | RateLimited",
                "from design.model.actuators.dummy import Dummy\n\n"
                "Actuator = Unlimited | Dummy | RateLimited",
            )
        ],
        "schemas/actuators.py": [
            (
                "ActuatorIn = Annotated[\n    IdealIn |",
                '''from design.model.actuators.dummy import Dummy


class DummyIn(WireOf[Dummy]):
    """A dummy."""

    RECORD = Dummy

    EXAMPLE: ClassVar[Example] = {"kind": "dummy"}

    kind: Literal["dummy"]
    accel_time_constant_s: TimeConstant = 0.1
    decel_time_constant_s: TimeConstant = 0.2
    model: ModelIn = "superposed"
    dead_time_s: DeadTime = 0.0


ActuatorIn = Annotated[\n    DummyIn | IdealIn |''',
            )
        ],
    },
    request={**CRANE, "actuator": {"kind": "dummy"}, "shaper": {"kind": "numzvd"}},
    command=("shapers",),
    documented="DummyIn",
)

PLANT = Addition(
    files={
        "design/model/plants/dummy.py": """
from dataclasses import dataclass

from design.model.plants.pendulum import Pendulum


@dataclass(frozen=True, slots=True, kw_only=True)
class Dummy(Pendulum):
    pass
"""
    },
    rows={
        "design/model/plants/registry.py": [
            (
                "Plant = Mode |",
                "from design.model.plants.dummy import Dummy\n\nPlant = Dummy | Mode |",
            )
        ],
        "schemas/plants.py": [
            (
                "PlantIn = Annotated[\n    ModeIn",
                '''from design.model.plants.dummy import Dummy


class DummyIn(WireOf[Dummy]):
    """A dummy."""

    RECORD = Dummy

    kind: Literal["dummy"]
    cable_length_m: Positive = 0.8
    damping_ratio: PlantDamping = 0.0
    gravity_m_s2: Positive = STANDARD_GRAVITY_M_S2


PlantIn = Annotated[\n    DummyIn | ModeIn''',
            )
        ],
    },
    request={**CRANE, "plant": {"kind": "dummy"}},
    command=("shapers", "--format", "json"),
    documented="DummyIn",
)

OPERATION = Addition(
    files={
        "service/operations/dummy.py": '''
"""A dummy."""

from matplotlib.figure import Figure

from schemas.base import Wire
from service.operations.operation import Operation


class DummyRequest(Wire):
    """A dummy."""

    sensitivity: None = None


class DummyResponse(Wire):
    """A dummy."""

    said: str


def run(request: DummyRequest) -> DummyResponse:
    """Do nothing."""
    return DummyResponse(said="dummy")


def draw(request: DummyRequest) -> Figure:
    """Draw nothing."""
    return Figure()


OPERATION = Operation(request=DummyRequest, response=DummyResponse, run=run, draw=draw)
'''
    },
    rows={
        "service/operations/table.py": [
            (
                "TABLE: dict[str, Row] = {\n",
                "TABLE: dict[str, Row] = {\n"
                '    "dummy": Row("/v1/dummies", "A dummy", "", "designs", "dummy", "a dummy"),\n',
            )
        ]
    },
    command=("--help",),
    documented='"/v1/dummies"',
)

FORMAT = Addition(
    files={
        "design/export/dummy.py": """
from dataclasses import replace

from design.export.csv_file import EXPORT as CSV

EXPORT = replace(CSV, name="dummy", suffix=".dummy", read=None)
"""
    },
    rows={
        "design/export/formats.py": [
            (
                "FORMATS: dict[str, Format] = {\n",
                'FORMATS: dict[str, Format] = {\n    "dummy": Format("dummy", is_program=True),\n',
            )
        ]
    },
    command=("table", "--help"),
    documented='"dummy"',
)

ADDITIONS = {
    "shaper": SHAPER,
    "actuator": ACTUATOR,
    "plant": PLANT,
    "operation": OPERATION,
    "format": FORMAT,
}

OPENAPI = """
import json
from service.http.app import create_app
from service.settings import Settings
print(json.dumps(create_app(Settings()).openapi(), separators=(",", ":")))
"""


def run(tree: Path, *arguments: str, given: object = None) -> str:
    """Run Python in the copy, and return what it prints."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=tree,
        input=json.dumps(given),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the packages, which commands find before those that are installed."""
    copy = tmp_path_factory.mktemp("tree")
    for name in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, copy / name, ignore=ignored)
    return copy


@pytest.fixture(params=ADDITIONS)
def added(request: pytest.FixtureRequest, tree: Path) -> Iterator[Addition]:
    """Make an addition, for as long as the test takes."""
    addition = ADDITIONS[request.param]
    before = {path: (tree / path).read_text() for path in addition.rows}
    for path, text in addition.files.items():
        (tree / path).write_text(text)
    for path, changes in addition.rows.items():
        changed = before[path]
        for old, new in changes:
            assert changed.count(old) == 1, f"{path} has no longer {old!r}"
            changed = changed.replace(old, new)
        (tree / path).write_text(changed)
    yield addition
    for path in addition.files:
        (tree / path).unlink()
    for path, text in before.items():
        (tree / path).write_text(text)


def test_an_addition_is_known_by_its_file_and_its_rows(added: Addition, tree: Path) -> None:
    assert len(added.files) + len(added.rows) <= MAX_FILES
    assert "dummy" in run(tree, "-m", "service", *added.command)
    assert added.documented in run(tree, "-c", OPENAPI)
    if added.request is not None:
        answer = json.loads(run(tree, "-m", "service", "design", "-", given=added.request))
        assert answer["certificate"]["verified"]
    if added is OPERATION:
        assert json.loads(run(tree, "-m", "service", "dummy", "-", given={})) == {"said": "dummy"}
    if added is FORMAT:
        assert run(tree, "-m", "service", "design", "-", "--format", "dummy", given=CRANE)


def test_without_its_file_and_rows_nothing_names_it(tree: Path) -> None:
    sources = [path for name in PACKAGES for path in (tree / name).rglob("*.py")]
    assert not [path for path in sources if "dummy" in path.read_text().lower()]
    assert "dummy" not in run(tree, "-m", "service", "shapers") + run(tree, "-c", OPENAPI)
