"""Files appear whole or not at all."""

import os
import socket
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from service.files import NotReplaceableError, write_whole


@pytest.mark.parametrize("mode", [0o600, 0o644, 0o664, 0o755])
def test_a_file_is_replaced_whole_and_hands_its_permissions_on(tmp_path: Path, mode: int) -> None:
    target = tmp_path / "out"
    target.write_bytes(b"old")
    target.chmod(mode)
    write_whole(target, b"new")
    assert target.read_bytes() == b"new"
    assert stat.S_IMODE(target.stat().st_mode) == mode
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize(("umask", "mode"), [(0o022, 0o644), (0o077, 0o600), (0o002, 0o664)])
def test_a_new_file_has_the_permissions_that_the_user_gives_to_files(
    tmp_path: Path, umask: int, mode: int
) -> None:
    # In a process of its own: the umask is of the whole process.
    code = "import sys, pathlib; from service.files import write_whole; "
    code += "write_whole(pathlib.Path(sys.argv[1]), b'new')"
    target = tmp_path / "out"
    subprocess.run([sys.executable, "-c", code, target], umask=umask, check=True)
    assert stat.S_IMODE(target.stat().st_mode) == mode


def test_what_is_no_file_of_the_users_is_not_replaced(tmp_path: Path) -> None:
    file, link, broken = tmp_path / "file", tmp_path / "link", tmp_path / "broken"
    file.write_bytes(b"old")
    link.symlink_to(file)
    broken.symlink_to(tmp_path / "nowhere")
    os.mkfifo(fifo := tmp_path / "fifo")
    (folder := tmp_path / "folder").mkdir()
    (fixed := tmp_path / "fixed").write_bytes(b"kept")
    fixed.chmod(0o444)
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(tmp_path / "socket"))
        for path, reason in (
            (link, f"a link to {file}; name the file itself"),
            (broken, f"a link to {tmp_path / 'nowhere'}"),
            (fifo, "a FIFO"),
            (folder, "a folder"),
            (fixed, "read-only"),
            (tmp_path / "socket", "a socket"),
            (Path("/dev/null"), "a device"),
        ):
            before = path.lstat()
            with pytest.raises(NotReplaceableError, match=rf"^cannot write {path}: it is {reason}"):
                write_whole(path, b"new")
            assert os.path.samestat(path.lstat(), before)
    assert (file.read_bytes(), fixed.read_bytes()) == (b"old", b"kept")
    assert not list(tmp_path.glob(".*.part"))


def test_a_failed_write_leaves_the_old_file_and_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "out"
    target.write_bytes(b"old")

    def fail(*_: Path) -> Path:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(OSError, match="No space"):
        write_whole(target, b"new")
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]
