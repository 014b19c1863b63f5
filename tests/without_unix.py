"""A Python from which all is hidden that Windows lacks: modules, a fork server, signals, calls."""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]

HIDING = '''
import asyncio.selector_events  # of Unix: it looks once what the system can
import multiprocessing.popen_fork, multiprocessing.reduction
import os, signal, socket, subprocess, sys, warnings

for name in ("fcntl", "grp", "pwd", "resource", "termios", "uvloop",
             "multiprocessing.forkserver", "multiprocessing.popen_forkserver"):
    sys.modules[name] = None
multiprocessing.reduction.HAVE_SEND_HANDLE = False  # by which Python knows of a fork server

# Python itself ends processes by what is hidden from us.
subprocess.Popen.kill = lambda self: self.send_signal(9)
multiprocessing.popen_fork.Popen.kill = lambda self: self._send_signal(9)
for name in ("SIGKILL", "SIGBUS", "SIGSYS", "SIGTRAP", "SIGHUP", "SIGUSR1", "SIGALRM"):
    delattr(signal, name)
for name in ("fork", "forkpty", "nice", "setpriority", "getpriority", "PRIO_PROCESS", "sysconf",
             "killpg", "getpgid", "setsid", "getloadavg", "fchmod"):
    delattr(os, name)

def socketpair():
    """Join two sockets as Python does on Windows."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        one = socket.create_connection(listener.getsockname())
        other, _ = listener.accept()
    return one, other

socket.socketpair = socketpair
del socket.AF_UNIX
# Without fcntl files are locked by files; Windows has locks of its own.
warnings.filterwarnings("ignore", "only soft file lock", UserWarning)
'''
"""Run at the start of a Python, whichever way it is started."""


def environment(folder: Path) -> dict[str, str]:
    """Return the environment of processes from which that is hidden.

    Parameters
    ----------
    folder
        Where what hides it is written.

    Returns
    -------
    dict of str to str
        Variables, those of this process among them.
    """
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(HIDING)
    kept = [os.environ["PYTHONPATH"]] if "PYTHONPATH" in os.environ else []
    return os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(ROOT), *kept])}


def python(program: str) -> tuple[str, ...]:
    """Return the command that runs a program."""
    return (sys.executable, "-c", program)
