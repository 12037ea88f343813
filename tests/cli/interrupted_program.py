"""The command line with methods that wait to be interrupted; run in a process of its own."""

import signal
import sys

from uqfold.cli import app, compare

named_problem = compare.named_problem


def with_waiting_methods(name: str) -> object:
    # not at the start: as in the real program, Ctrl-C is taken over before anything is imported
    from uqfold.methods import registry

    for method in ("Quick", "Endless", "Swallowing"):
        registry._BUILT_IN[method.lower()] = f"tests.comparison.fakes:{method}"
    return named_problem(name)


if __name__ == "__main__":
    # a program started in the background may have inherited that Ctrl-C is ignored
    signal.signal(signal.SIGINT, signal.default_int_handler)
    compare.named_problem = with_waiting_methods
    app.main(sys.argv[1:])
