"""Files of moves: what their blocks do when they are called, their comments, formats and names."""

import re
import subprocess
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from design.export.formats import FORMATS
from design.export.registry import EXPORTS
from design.export.structured_text import EXPORT as STRUCTURED_TEXT
from design.export.text_blocks import move_program
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.tables.rows import Real
from schemas.maneuvers import ManeuverRequest
from service.operations.move_file import move_file
from tests.design.export.test_lookup import table, written
from tests.design.export.test_plc_files import blocks_of, sections_of, statements_of
from tests.played_moves import FLAGS, Calls, Case, InC, Played, case, play_in_text, steady
from tests.plc_files import plcopen_again, plcopen_project, plcopen_text, scl_text, twincat_text
from tests.refusals import refused
from tests.structured_text import Block

EDITORS: dict[str, Callable[[bytes], str]] = {
    "plcopen": plcopen_text,
    "twincat": twincat_text,
    "scl": scl_text,
}

CYCLE_S = 0.05


@pytest.fixture(scope="module")
def apart() -> Case:
    drive = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.15, model="switched")
    return case(Pendulum(cable_length_m=9.0), drive, "numzv", speed_m_s=1.0, distance_m=12.0)


@pytest.fixture(scope="module")
def joint() -> Case:
    return case(
        Mode(natural_frequency_rad_s=3.0, damping_ratio=0.02),
        FirstOrder(accel_time_constant_s=0.05, decel_time_constant_s=0.03),
        "numzvd",
        speed_m_s=0.5,
        distance_m=-0.8,
        joint=True,
    )


@pytest.fixture(scope="module")
def sampled() -> Case:
    drive = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.15)
    return case(
        Pendulum(cable_length_m=9.0),
        drive,
        "numzv",
        speed_m_s=1.0,
        distance_m=12.0,
        sample_time_s=CYCLE_S,
    )


@pytest.fixture(params=["c", "st"])
def play(
    request: pytest.FixtureRequest, apart: Case, tmp_path: Path
) -> Callable[[str, Calls], Played]:
    """Play a sequence of a move in C, or in Structured Text."""
    name = apart.blocks().name
    if request.param == "c":
        compiled = InC(tmp_path, [apart], single=False)
        return lambda part, calls: compiled.play(f"{name}_{part}", calls)
    text = apart.written("st").decode()
    return lambda part, calls: play_in_text(text, f"{name}_{part}", calls)


def test_an_edge_begins_a_move_and_another_one_changes_nothing(
    play: Callable[[str, Calls], Played],
) -> None:
    once = [(True, False, CYCLE_S)] * 300
    wanted = play("move", once)
    pulsed: Calls = [(call % 3 == 0, False, CYCLE_S) for call in range(300)]
    found = play("move", pulsed)
    ends = int(wanted.done.argmax())
    np.testing.assert_array_equal(found.share[: ends + 1], wanted.share[: ends + 1])
    assert found.done[ends]
    # Done until execute is FALSE, then a new edge begins it anew.
    assert wanted.done[ends:].all()
    again = [(True, False, CYCLE_S)] * (ends + 1) + [(False, False, CYCLE_S)] * 2
    twice = play("move", again + again)
    np.testing.assert_array_equal(twice.share[: ends + 3], twice.share[ends + 3 :])
    assert not twice.done[ends + 1 : ends + 4].any()


def test_a_block_at_rest_gives_no_speed(play: Callable[[str, Calls], Played]) -> None:
    for part in ("start", "stop", "move"):
        idle = play(part, [(False, False, CYCLE_S)] * 3 + [(False, False, -1.0)])
        for field in ("share", "velocity_m_s", "busy", "done", "error"):
            assert not getattr(idle, field).any()


@pytest.mark.parametrize("cycle_s", [0.0, -0.01, 3.1])
@pytest.mark.parametrize("part", ["start", "stop", "move"])
def test_a_wrong_cycle_ends_a_move(
    play: Callable[[str, Calls], Played], part: str, cycle_s: float
) -> None:
    found = play(part, [(True, False, CYCLE_S)] * 8 + [(True, False, cycle_s)] * 2)
    assert found.busy[:8].all()
    assert not found.error[:8].any()
    assert not found.busy[8:].any()
    assert not found.share[8:].any()
    assert found.error[8:].all()
    # It stays until execute is FALSE, and does not begin again by itself.
    after = play(
        part,
        [(True, False, cycle_s), *[(True, False, CYCLE_S)] * 2, (False, False, CYCLE_S)],
    )
    assert after.error.tolist() == [1, 1, 1, 0]
    assert not after.busy.any()


@pytest.mark.parametrize("part", ["start", "stop", "move"])
def test_cancel_ends_a_move_at_speed_0(play: Callable[[str, Calls], Played], part: str) -> None:
    for ahead in (5, 100, 300):  # within the start, later, and after the end of each
        calls: Calls = [(True, False, CYCLE_S)] * ahead + [(True, True, CYCLE_S)] * 2
        found = play(part, calls + [(True, False, CYCLE_S)] * 2)
        assert not found.share[ahead:].any()
        assert not found.busy[ahead:].any()
        assert not found.done[ahead:].any()
        assert not found.error.any()


def test_the_start_holds_its_cruise_while_execute_is_true(
    play: Callable[[str, Calls], Played],
) -> None:
    found = play("start", [(True, False, CYCLE_S)] * 200 + [(False, False, CYCLE_S)])
    ends = int(found.done.argmax())
    assert (found.share[ends:-1] == 1.0).all()
    assert found.share[-1] == 0.0


def test_the_example_plays_the_move(apart: Case) -> None:
    text = apart.written("st").decode()
    (example,) = re.findall(r"(?s)PROGRAM \w+_main\n.*?END_PROGRAM", text)
    name, (*_, whole) = apart.blocks().name, apart.blocks().sequences
    main = Block(f"{text}\n{example}", f"{name}_main")
    calls = steady(0.01, whole.end_s)
    wanted = play_in_text(text, f"{name}_move", calls).velocity_m_s
    found = [main(go=True)["velocity_m_s"] for _ in calls]
    np.testing.assert_array_equal(found, wanted)


def test_the_example_of_start_and_stop_never_jumps(apart: Case) -> None:
    """Whatever an operator does, the speed is that of a start, a cruise or a stop."""
    text = apart.written("st").decode().replace("0.01", "0.05")
    (example,) = re.findall(r"(?s)PROGRAM \w+_drive\n.*?END_PROGRAM", text)
    name = apart.blocks().name
    drive = Block(f"{text}\n{example}", f"{name}_drive")
    start, stop, _ = apart.blocks().sequences
    parts = {}
    for one in (start, stop):
        played = play_in_text(text, f"{name}_{one.name}", steady(0.05, one.end_s))
        # A stop may begin in the call in which the start is done.
        parts[one.name] = played.velocity_m_s[: int(played.done.argmax())]
    rng = np.random.default_rng(3)
    go, given = False, []
    for call in range(3000):
        if rng.random() < 0.02:
            go = not go
        given.append(float(drive(go=go or call == 5)["velocity_m_s"]))
    # Cut at each start from 0 and each end of a stop: a start, levels of 1, a stop.
    found = np.array(given)
    at = 0
    moves = 0
    while at < found.size:
        if found[at] == 0.0:
            at += 1
            continue
        up = parts["start"]
        if at + up.size > found.size:
            break
        np.testing.assert_array_equal(found[at : at + up.size], up)
        at += up.size
        while at < found.size and found[at] == 1.0 and not stops(found[at:], parts["stop"]):
            at += 1
        if at + parts["stop"].size > found.size:
            break
        np.testing.assert_array_equal(found[at : at + parts["stop"].size], parts["stop"])
        at += parts["stop"].size
        moves += 1
    assert moves > 3


def stops(found: np.ndarray, stop: np.ndarray) -> bool:
    """Return whether a stop begins here, or the record ends."""
    return found.size < stop.size or bool((found[: stop.size] == stop).all())


@pytest.mark.parametrize("real", ["LREAL", "REAL"])
@pytest.mark.parametrize("which", ["apart", "joint", "sampled"])
@pytest.mark.parametrize("name", EDITORS)
def test_files_for_editors_hold_the_blocks_of_the_structured_text(
    name: str, which: str, real: Real, request: pytest.FixtureRequest
) -> None:
    one: Case = request.getfixturevalue(which)
    of = real
    wanted = blocks_of(one.written("st", of).decode())
    found = blocks_of(EDITORS[name](one.written(name, of)))
    assert found.keys() == wanted.keys()
    for block, text in wanted.items():
        assert statements_of(found[block]) == statements_of(text)
        assert Block(found[block], block).values == Block(text, block).values
        if name == "twincat":
            assert found[block] == text
        if name == "plcopen":
            assert sorted(sections_of(found[block])) == sorted(sections_of(text))


def test_plcopen_xml_of_a_move_goes_round(apart: Case) -> None:
    text = apart.written("plcopen")
    project = plcopen_project(text)
    assert plcopen_project(plcopen_again(project)) == project
    assert plcopen_text(plcopen_again(project)) == plcopen_text(text)


@pytest.mark.parametrize("which", ["apart", "joint", "sampled"])
def test_blark_parses_the_blocks(which: str, request: pytest.FixtureRequest) -> None:
    from blark.parse import parse_source_code

    one: Case = request.getfixturevalue(which)
    text = one.written("st").decode()
    examples = "\n".join(re.findall(r"(?s)PROGRAM .*?END_PROGRAM", text))
    parsed = parse_source_code(f"{text}\n{examples}").transform().items
    names = [f"{one.blocks().name}_{part.name}" for part in one.blocks().sequences]
    assert [item.name for item in parsed][: len(names)] == names


def test_the_parts_are_the_whole_text(apart: Case) -> None:
    text = apart.written("st").decode()
    program = move_program(apart.blocks())
    assert [block.name for block in program.blocks] == re.findall(r"FUNCTION_BLOCK (\w+_\w+)", text)
    assert program.remark.splitlines()[0] in text
    assert "*)" not in program.remark


def test_the_comment_says_of_what_the_move_is_and_what_is_left(
    apart: Case, joint: Case, sampled: Case
) -> None:
    heads = {}
    for which, one in (("apart", apart), ("joint", joint), ("sampled", sampled)):
        for name in ("c", "st"):
            text = one.written(name).decode()
            head = " ".join(text[: text.index("How to call it")].split())
            heads[which] = head
            blocks = one.blocks()
            assert f"request sha256 {blocks.sha256}" in head
            assert "shapersmith 0.1.0" in head
            assert f"{one.move.distance_m:.9g} m at {one.move.speed_m_s:g} m/s" in head
            assert f"in {one.move.duration_s:.9g} s by {one.kind}" in head
            assert f"residual with the drive given: {one.move.residual:.3g}" in head
            assert one.move.certificate.method in head
            comments = re.findall(r"(?s)\(\*.*?\*\)|/\*.*?\*/", text)
            assert max(len(line) for part in comments for line in part.splitlines()) <= 100
    assert "plant: cable 9 m, 0.16613 Hz, period 6.0192 s" in heads["apart"]
    assert "accel time constant 0.3 s, decel time constant 0.15 s, switched" in heads["apart"]
    assert "cycles of 1 ms: residual " in heads["apart"]
    assert "done of the start waits" in heads["apart"]
    assert "damping ratio 0.02" in heads["joint"]
    assert "solved as one" in heads["joint"]
    assert "start and stop are no blocks" in heads["joint"]
    assert "on samples of 0.05 s: residual" in heads["sampled"]


def test_a_claim_for_an_ideal_drive_is_told_as_one() -> None:
    drive = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
    one = case(Pendulum(cable_length_m=0.8), drive, "umzvd", speed_m_s=0.2, distance_m=0.6)
    assert one.move.for_ideal
    head = " ".join(one.written("st").decode().partition("*)")[0].split())
    assert "certificate: verified for an ideal drive only, not for the drive given" in head
    assert f"residual with the drive given: {one.move.residual:.3g}" in head


def test_levels_that_alternate_are_no_table(apart: Case, joint: Case) -> None:
    for one in (apart, joint):
        for name in ("c", "st"):
            assert "levels" not in one.written(name).decode().replace("levels that", "")


def test_several_files_may_be_in_one_program(
    apart: Case, joint: Case, sampled: Case, tmp_path: Path
) -> None:
    texts = [one.written("c").decode() for one in (apart, joint, sampled)]
    texts.append(written(EXPORTS["c"], table("length")))
    for place, text in enumerate(texts):
        (tmp_path / f"part{place}.h").write_text(text)
    (tmp_path / "main.c").write_text(
        "".join(f'#include "part{place}.h"\n' for place in range(len(texts)))
        + "int main(void) { return 0; }\n"
    )
    for defined in ([], ["-DSHAPERSMITH_FLOAT"]):
        subprocess.run(
            ["gcc", *FLAGS, *defined, "-o", str(tmp_path / "main"), str(tmp_path / "main.c")],
            check=True,
        )
    names = [
        set(re.findall(r"FUNCTION_BLOCK (\w+)", text))
        for text in (
            *(
                one.written("st", real).decode()
                for one in (apart, joint, sampled)
                for real in ("LREAL", "REAL")
            ),
            written(STRUCTURED_TEXT, table("length")),
        )
    ]
    assert all(not one & other for one, other in pairwise(sorted(names, key=sorted)))
    assert len(set.union(*names)) == sum(map(len, names))


def test_the_same_move_gives_the_same_bytes(apart: Case) -> None:
    for name, row in FORMATS.items():
        assert (EXPORTS[name].move is not None) == row.plays_moves
        if row.plays_moves:
            assert apart.written(name) == apart.written(name)


def test_a_format_without_moves_is_refused() -> None:
    request = ManeuverRequest.model_validate({
        "plant": {"kind": "mode", "natural_frequency_rad_s": 3.0},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "numzv"},
        "speed_m_s": 1.0,
        "distance_m": 3.0,
    })
    with refused("format_without_moves", "format"):
        move_file(request, "csv")
    assert b"FUNCTION_BLOCK" in move_file(request, "st")


def test_the_longest_names_are_short_enough() -> None:
    one = case(Mode(natural_frequency_rad_s=3.0), Ideal(), "numzvd", speed_m_s=0.5, distance_m=3.0)
    longest = max(
        len(word) for word in re.findall(r"FUNCTION_BLOCK (\w+)", one.written("st").decode())
    )
    assert longest <= 30  # as PLC editors take
