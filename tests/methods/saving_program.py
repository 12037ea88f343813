"""Saves one session again and again; run by several processes on one file at the same time."""

import sys

from tests.methods.test_ask_tell import ASKED, SYSTEM, Walk, outside
from uqfold.methods.session_file import SessionFileError


def main(path: str, seed: int) -> None:
    """Tell and save row by row; say how many were saved, or that another one was first."""
    session = Walk().start(outside(), ASKED, rng=seed)
    rows = session.ask()
    for x in rows[:, None]:
        session.tell(x, SYSTEM.response(x))
        try:
            session.save(path)
        except SessionFileError:
            print("refused")
            return
    print(f"saved {session.n_evals}")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
