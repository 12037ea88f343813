"""Models that run one sample at a time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold import checks
from uqfold.problems.responses import one_number
from uqfold.typing import FloatArray


class RowModel(ABC):
    """A model that runs one sample at a time; its failed runs leave the other samples alone."""

    parallel: int = 1
    """Runs to be made at the same time where no executor is given."""

    @abstractmethod
    def run(self, x: FloatArray) -> Any:
        """Return the response of one sample x (d,), a number; raise if the run fails."""

    def with_time_limit(self, seconds: float) -> RowModel | None:
        """Return this model with a limit on the time of one run, or None if it cannot keep one."""
        del seconds
        return None

    def stop(self) -> bool:
        """End the runs that other threads are making; tell whether this model can do that."""
        return False

    def negated(self) -> RowModel:
        """Return the model of the response with the other sign, for limit states."""
        return _NegatedRows(self, self.parallel)

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the responses (n,) of X (n, d); raise what the first failed run raises."""
        return np.array([one_number(self.run(row)) for row in x], dtype=np.float64)


@dataclass(frozen=True)
class _NegatedRows(RowModel):
    model: RowModel
    parallel: int

    def run(self, x: FloatArray) -> Any:
        """Return the response of one sample x (d,)."""
        returned = self.model.run(x)
        y = one_number(returned)
        # what makes it a failed run is told from it
        return returned if np.isnan(y) else -y

    def with_time_limit(self, seconds: float) -> RowModel | None:
        """Return the same with the limit that the model itself keeps."""
        kept = self.model.with_time_limit(seconds)
        return None if kept is None else _NegatedRows(kept, self.parallel)

    def stop(self) -> bool:
        """End the model's runs."""
        return self.model.stop()


@dataclass(frozen=True)
class PerSample(RowModel):
    """A scalar function of one sample as a response model; see `per_sample`."""

    function: Callable[[FloatArray], Any]

    def __post_init__(self) -> None:
        checks.function("function", self.function, "give a function of one sample x (d,)")

    def run(self, x: FloatArray) -> Any:
        """Return what the function returns for one sample x (d,)."""
        return self.function(x.copy())


def per_sample(function: Callable[[FloatArray], Any]) -> PerSample:
    """Make a response model of a scalar function of one sample.

    Parameters
    ----------
    function
        Takes x (d,), columns shared inputs first; returns one number. NaN or an exception is a
        failed run, +inf is a valid response.

    Returns
    -------
    PerSample
        A model that takes X (n, d). An executor is handed single samples, so that all its
        workers are busy and each finished run is stored.

    Raises
    ------
    TypeError
        If it is not a function.

    Examples
    --------
    >>> import numpy as np
    >>> model = per_sample(lambda x: x[0] ** 2)
    >>> model(np.array([[2.0], [3.0]]))
    array([4., 9.])
    """
    return PerSample(function)
