"""The command line with methods that wait to be interrupted; run in a process of its own."""

import sys

from uqfold.cli import app

named_case = app.named_case


def with_waiting_methods(name: str) -> object:
    # not at the start: as in the real program, Ctrl-C is taken over before anything is imported
    from uqfold.methods import registry

    for method in ("Quick", "Endless", "Swallowing"):
        registry._BUILT_IN[method.lower()] = f"tests.comparison.fakes:{method}"
    return named_case(name)


if __name__ == "__main__":
    app.named_case = with_waiting_methods
    app.main(sys.argv[1:])
