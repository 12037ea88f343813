"""A program whose external code starts processes that do not want to end; run to be killed.

Words: how it is run (``threads``, ``processes``, ``slow``, ``direct``), a folder, a tag. Each run
starts three sleeping processes that carry the tag, two of which leave its session: one after a
double fork, with an empty environment.
"""

import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from uqfold.evaluation import Evaluator, ExternalCode, Processes, Regex, guard
from uqfold.typing import FloatArray

SLEEPING = "import sys, time; open(sys.argv[2], 'w'); time.sleep(600)"
FAMILY = """
import os, subprocess, sys
sleeping, tag, folder = sys.argv[1:4]
words = [sys.executable, "-I", "-S", "-c", sleeping, tag]
def start(name):
    return [*words, os.path.join(folder, name + str(os.getpid()))]
subprocess.Popen(start("child"))
subprocess.Popen(start("session"), start_new_session=True)
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        os.execve(sys.executable, start("daemon"), {})
    os._exit(0)
"""
WAITING = FAMILY + "import time; time.sleep(600)"
ENDING = FAMILY + "import time\nwhile len(os.listdir(folder)) < 3: time.sleep(0.01)\nprint('y = 1')"


def family(program: str, folder: Path, tag: str, timeout: float | None = None) -> ExternalCode:
    """A code of one input that starts sleeping processes."""
    return ExternalCode(
        [sys.executable, "-I", "-S", "-c", program, SLEEPING, tag, str(folder), "{{a}}"],
        ["a"],
        Regex(r"y = (\S+)"),
        timeout=timeout,
        parallel=2,
        keep="none",
    )


def tagged(tag: str) -> list[int]:
    """Ids of the processes that carry the tag, but for this one."""
    found = []
    for one in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = one.read_bytes().split(b"\0")
        except OSError:
            continue
        # no zombies: these have no words any more
        if tag.encode() in words and b"tests.evaluation.orphans" not in words:
            found.append(int(one.parent.name))
    return found


class SlowlyKilled:
    """A model in whose worker process each kill takes a while, as where the machine is busy."""

    def __init__(self, model: ExternalCode) -> None:
        self.model = model

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Load it in a worker."""
        self.__dict__.update(state)
        kill = guard._kill

        def slow(how: Callable[[int, int], None], process: int) -> None:
            kill(how, process)
            time.sleep(0.05)

        guard._kill = slow

    def __call__(self, x: FloatArray) -> FloatArray:
        """Run the code."""
        return self.model(x)


def main(how: str, folder: str, tag: str) -> None:
    """Run four samples, which never end."""
    # a program started in the background may have inherited that Ctrl-C is ignored
    signal.signal(signal.SIGINT, signal.default_int_handler)
    model = family(WAITING, Path(folder), tag)
    x = np.arange(4.0)[:, None]
    if how == "direct":
        model(x)
    elif how == "threads":
        Evaluator().session(model, 1, None).evaluate(x)
    else:
        with Processes(2) as pool:
            run = SlowlyKilled(model) if how == "slow" else model
            Evaluator(executor=pool).session(run, 1, None).evaluate(x)


if __name__ == "__main__":
    main(*sys.argv[1:])
