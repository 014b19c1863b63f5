"""`import shapersmith` beside modules of the user that have the names of its packages."""

import os
import subprocess
import sys
import zipfile
from importlib.metadata import version
from pathlib import Path

import pytest

import shapersmith
from tests.conftest import CRANE, running_service

ROOT = Path(__file__).parents[1]

PACKAGES = ("shapersmith", "design", "schemas", "service")

COMMAND_LINE = """\
import os, sys
sys.path[0] = {root!r}  # as the installed command, which does not search the working folder
os.chdir({folder!r})
from service.__main__ import main
sys.exit(main(sys.argv[1:]))
"""

IN_A_WORKER = """\
import multiprocessing, sys
from concurrent.futures import ProcessPoolExecutor

def design_in_a_worker():
    import shapersmith, json
    from service.dispatch import answer
    answered = answer("design", json.dumps({request!r}).encode())
    return json.loads(answered.outcome)["certificate"]["verified"]

if __name__ == "__main__":
    {first}
    context = multiprocessing.get_context({method!r})
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        print(pool.submit(design_in_a_worker).result())
"""

CLASH = "ImportError: shapersmith needs its own package"

OURS_FIRST = f"sys.path.insert(0, {str(ROOT)!r})"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a module `design` and a package `service` of a user."""
    (tmp_path / "design.py").write_text("print('design of the user')\n")
    (tmp_path / "service").mkdir()
    (tmp_path / "service" / "__init__.py").write_text("print('service of the user')\n")
    return tmp_path


def run(
    folder: Path, program: str, path: Path = ROOT, arguments: tuple[str, ...] = ()
) -> subprocess.CompletedProcess[str]:
    """Run a program that stands in a folder, which comes first on its path."""
    (folder / "program.py").write_text(program)
    return subprocess.run(
        [sys.executable, "program.py", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(path)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_package_knows_its_version_and_is_typed() -> None:
    assert shapersmith.__version__ == version("shapersmith")
    assert all((ROOT / name / "py.typed").exists() for name in PACKAGES)


def test_a_module_that_is_imported_already_is_named_with_its_file(folder: Path) -> None:
    done = run(folder, "import design\nimport shapersmith")
    error = done.stderr.splitlines()[-1]
    assert done.returncode == 1
    assert error.startswith(CLASH)
    assert f"'design' in {ROOT}" in error
    assert f"stands for {folder / 'design.py'}, which is imported already" in error


def test_the_error_names_all_ways_out(folder: Path) -> None:
    error = run(folder, "import shapersmith").stderr
    for way in ("fresh interpreter", f"put {ROOT} ahead", "over HTTP", "rename that module"):
        assert way in error


def test_a_module_that_would_be_found_first_is_named_and_not_run(folder: Path) -> None:
    (folder / "design.py").unlink()
    done = run(folder, "import shapersmith")
    assert CLASH in done.stderr
    assert f"{folder / 'service' / '__init__.py'}, which comes first on sys.path" in done.stderr
    assert not done.stdout


def test_the_command_names_the_clash(folder: Path) -> None:
    program = "import runpy; runpy.run_module('shapersmith', run_name='__main__')"
    done = run(folder, program)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith(CLASH)


def test_the_command_runs_where_the_names_are_ours(tmp_path: Path) -> None:
    program = "import runpy; runpy.run_module('shapersmith', run_name='__main__')"
    done = run(tmp_path, program, arguments=("--help",))
    assert (done.returncode, done.stderr) == (0, "")
    assert "design" in done.stdout


def test_a_module_without_a_file_is_a_clash_too(tmp_path: Path) -> None:
    program = "import sys, types\nsys.modules['schemas'] = types.ModuleType('schemas')\n"
    done = run(tmp_path, program + "import shapersmith")
    assert "stands for a module without a file" in done.stderr


def test_a_module_that_is_found_last_does_not_matter(folder: Path) -> None:
    program = f"import sys\n{OURS_FIRST}\nimport shapersmith, design.pipeline, service.dispatch"
    done = run(folder, program)
    assert (done.returncode, done.stdout) == (0, "")


def test_a_module_that_comes_first_later_changes_nothing(folder: Path) -> None:
    program = f"""import sys
sys.path.remove({str(folder)!r})
import shapersmith
sys.path.insert(0, {str(folder)!r})
import design.pipeline, service.dispatch
"""
    done = run(folder, program)
    assert (done.returncode, done.stdout) == (0, "")


def test_a_folder_that_is_no_package_does_not_clash(tmp_path: Path) -> None:
    (tmp_path / "service").mkdir()
    assert run(tmp_path, "import shapersmith, service.dispatch").returncode == 0


@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_workers_of_a_program_end_in_the_same_error(folder: Path, method: str) -> None:
    done = run(folder, IN_A_WORKER.format(first="import design", method=method, request=CRANE))
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith(CLASH)


@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_workers_design_where_our_packages_come_first(folder: Path, method: str) -> None:
    program = IN_A_WORKER.format(first=OURS_FIRST, method=method, request=CRANE)
    done = run(folder, program)
    assert done.stdout == "True\n", done.stderr


def test_a_service_in_such_a_folder_designs_and_makes_tables(folder: Path, tmp_path: Path) -> None:
    command = (sys.executable, "-c", COMMAND_LINE.format(root=str(ROOT), folder=str(folder)))
    table = {"design": CRANE, "designs": [{}], "columns": ["residual"]}
    with (
        running_service(tmp_path / "log", command=command, workers=1, job_workers=1) as service,
        service.client() as client,
    ):
        assert client.post("/v1/designs", json=CRANE).status_code == 200
        job = client.post("/v1/tables", json=table).json()["id"]
        events = client.get(f"/v1/tables/{job}/events").text
        assert client.get(f"/v1/tables/{job}").json()["state"] == "done", events


def test_the_wheel_holds_the_packages_and_their_types(folder: Path, tmp_path: Path) -> None:
    build = ("-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet")
    subprocess.run([sys.executable, *build, "-w", tmp_path / "wheel", ROOT], check=True)
    (wheel,) = (tmp_path / "wheel").iterdir()
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    assert all((site / name / "py.typed").exists() for name in PACKAGES)
    first = f"import sys; sys.path.insert(0, {str(site)!r})\n"
    program = "import shapersmith, design.pipeline; print(design.pipeline.__file__)"
    done = run(folder, first + program, path=site)
    assert done.stdout == f"{site / 'design' / 'pipeline.py'}\n", done.stderr
    assert CLASH in run(folder, program, path=site).stderr
