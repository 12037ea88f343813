"""Methods whose hook is a generator: it yields rows to run and receives their responses."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Generator
from dataclasses import dataclass
from typing import TypeAlias, final

from uqfold.evaluation import TimeLimitError
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.task import Solution, Task
from uqfold.typing import FloatArray

Steps: TypeAlias = Generator[FloatArray, FloatArray, Solution]
"""Yields rows X (n, d), is sent their responses y (n,), returns the solution."""


@dataclass(frozen=True)
class SequentialMethod(ReliabilityMethod):
    """A method that asks for evaluations step by step; its hook is the generator `_steps`.

    When the wall-clock limit of the evaluator is over, `TimeLimitError` is raised at the ``yield``.
    """

    @abstractmethod
    def _steps(self, task: Task) -> Steps:
        """Answer the criteria of `task`: yield rows to run, receive their responses."""

    @final
    def _solve(self, task: Task) -> Solution:
        steps = self._steps(task)
        try:
            x = next(steps)
            while True:
                try:
                    y = task.session.evaluate(x)
                except TimeLimitError as error:
                    # a method may conclude from the runs that it has
                    x = steps.throw(error)
                else:
                    x = steps.send(y)
        except StopIteration as stop:
            solution: Solution = stop.value
            return solution
