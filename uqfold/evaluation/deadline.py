"""The wall-clock limit of one estimate."""

from __future__ import annotations

import math
import re
import time

from uqfold.evaluation.errors import TimeLimitError

GRACE_SECONDS, GRACE_SHARE = 3.0, 0.1
"""Time beyond the limit for summing up what there is: so much, and this share of the limit."""
_LIMIT = "the wall-clock limit of"


class Deadline:
    """The end of one estimate's time; without a limit it never comes.

    Parameters
    ----------
    seconds
        From now on; None for no limit.
    """

    def __init__(self, seconds: float | None) -> None:
        self._seconds = seconds
        self._end = math.inf if seconds is None else time.monotonic() + seconds
        self._last = self._end

    @property
    def left(self) -> float:
        """Seconds for further runs: infinite without a limit, negative when it is over."""
        return math.inf if self._seconds is None else self._end - time.monotonic()

    def check(self, n_evals: int, *, summing_up: bool) -> None:
        """Raise if the time is over; whoever is `summing_up` has some more once that was raised.

        Raises
        ------
        TimeLimitError
            Saying how many evaluations there are, `n_evals`.
        """
        if self._seconds is None or time.monotonic() < (self._last if summing_up else self._end):
            return
        self._last = self._end + GRACE_SECONDS + GRACE_SHARE * self._seconds
        raise TimeLimitError(
            f"{_LIMIT} {self._seconds:g} s is over after {n_evals} runs "
            "(max_seconds of the evaluator)"
        )


def limit_told(message: str) -> float | None:
    """Return the limit (s) that ended an estimate, as the message of its row tells; None: none."""
    found = re.search(rf"{_LIMIT} (\S+) s is over", message)
    return float(found[1]) if found else None
