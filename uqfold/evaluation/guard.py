"""The guard of one program: ends whatever the program has started, when its caller wants or dies.

Run as a script by `programs`, once for each run. The standard input is a line to the caller. As
long as the caller holds it the program runs; when it is cut, by the caller or because the caller
is gone, the guard kills the program and all its descendants. What a program leaves running when it
ends is killed too. On Linux the guard is the reaper of all that lose their parents
(`prctl(2)`, ``PR_SET_CHILD_SUBREAPER``), so that neither ``setsid`` nor a double fork escapes;
elsewhere it kills the program's process group and the descendants that ``ps`` knows.

It needs nothing but the standard library, and little of that, since its start is part of each run.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import time
from collections.abc import Callable

ENDED, NOT_STARTED = "ended", "not started"
"""First words of what the guard reports: followed by an exit code, or by a reason."""

_LINE = 0
_LOOK_SECONDS = 1.0
"""How often to look whether the caller is still there, should a copy of its line be left."""
_KILLING_SECONDS = 10.0
"""What cannot be killed in this time, such as a process that waits for a dead disk, is left."""
_ENDING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP) if os.name == "posix" else ()
_SET_PARENT_DEATH_SIGNAL, _SET_CHILD_SUBREAPER = 1, 36


def main(command: list[str]) -> None:
    """Run the program, watch over it, and report how it ended."""
    caller = os.getppid()
    line = os.dup(_LINE)
    os.dup2(os.open(os.devnull, os.O_RDONLY), _LINE)
    adopt_orphans()
    signals = _signals()
    try:
        program = _started(command)
    except OSError as error:
        _tell(line, f"{NOT_STARTED} {error.strerror}")
        return
    code = _watched(program, caller, line, signals)
    end_descendants(program)
    if code is not None:
        _tell(line, f"{ENDED} {code}")


def adopt_orphans() -> None:
    """Become the parent of all descendants whose parents die; does nothing but on Linux."""
    _prctl(_SET_CHILD_SUBREAPER, 1)


def end_descendants(group: int | None = None) -> None:
    """Kill all descendants of this process, and the process group of one that has its own."""
    last = time.monotonic() + _KILLING_SECONDS
    while _has_children() and time.monotonic() < last:
        for process in descendants(os.getpid()):
            _kill(os.kill, process)
        time.sleep(0.002)
    if group is not None:
        _kill(os.killpg, group)


def descendants(process: int) -> list[int]:
    """Return the ids of all processes below one, parents first."""
    children: dict[int, list[int]] = {}
    for child, parent in _parents():
        children.setdefault(parent, []).append(child)
    found = [process]
    for one in found:
        found += children.pop(one, [])
    return found[1:]


def _watched(program: int, caller: int, line: int, signals: int) -> int | None:
    """Wait for the program and return its exit code; None if it is to be ended."""
    while os.getppid() == caller:
        ready, _, _ = select.select([line, signals], [], [], _LOOK_SECONDS)
        if line in ready:
            return None
        if signals in ready and not set(_ENDING).isdisjoint(os.read(signals, 4096)):
            return None
        try:
            while (ended := os.waitpid(-1, os.WNOHANG))[0]:
                if ended[0] == program:
                    return os.waitstatus_to_exitcode(ended[1])
        except ChildProcessError:
            return None
    return None


def _started(command: list[str]) -> int:
    """Start the program in a session of its own and return its id; OSError if it cannot be."""
    told, tell = os.pipe()
    program = os.fork()
    if program == 0:
        try:
            os.setsid()
            # should the guard itself be killed
            _prctl(_SET_PARENT_DEATH_SIGNAL, signal.SIGKILL)
            signal.signal(signal.SIGPIPE, signal.SIG_DFL)
            os.execvp(command[0], command)
        except OSError as error:
            os.write(tell, b"%d" % (error.errno or 0))
        finally:
            os._exit(127)
    os.close(tell)
    with os.fdopen(told, "rb") as stream:
        number = stream.read()
    if number:
        os.waitpid(program, 0)
        raise OSError(int(number), os.strerror(int(number)))
    return program


def _signals() -> int:
    """Return a descriptor from which signals are read; the program starts with the usual ones."""
    told, tell = os.pipe()
    for descriptor in (told, tell):
        os.set_blocking(descriptor, False)
    signal.set_wakeup_fd(tell)
    # handlers, unlike what is ignored or blocked, are not handed on to the program
    for number in (signal.SIGCHLD, *_ENDING):
        signal.signal(number, lambda *_: None)
    signal.pthread_sigmask(signal.SIG_SETMASK, ())
    return told


def _has_children() -> bool:
    """Reap the children that have ended, and tell whether there are others."""
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        return False
    return True


def _parents() -> list[tuple[int, int]]:
    """Return (process, its parent) for all processes that can be seen."""
    if not os.path.isdir("/proc/self"):
        with os.popen("ps -A -o pid= -o ppid=") as listing:
            return [(int(one), int(two)) for one, two in map(str.split, listing)]
    found = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", "rb") as stream:
                # the name of a program, in parentheses, may hold anything
                found.append((int(name), int(stream.read().rpartition(b")")[2].split()[1])))
        except (OSError, IndexError):
            continue
    return found


def _prctl(option: int, value: int) -> None:
    if sys.platform != "linux":
        return
    try:
        import ctypes

        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)
    except (ImportError, OSError, AttributeError):
        return


def _kill(kill: Callable[[int, int], None], process: int) -> None:
    try:
        kill(process, signal.SIGKILL)
    except OSError:
        return


def _tell(line: int, text: str) -> None:
    try:
        os.write(line, text.encode())
    except OSError:
        return


if __name__ == "__main__":
    main(sys.argv[1:])
