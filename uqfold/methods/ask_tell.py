"""Methods that ask for evaluations step by step, and let a caller make them himself.

The hook of such a method is a generator that yields rows X and receives their responses y. Driven
by `estimate` it calls the model; driven by an `AskTellSession` it waits for whoever runs the model
elsewhere: a cluster, a test bench, another program. Both give the same answer.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import final

from uqfold.checks import path as checked_path
from uqfold.evaluation import Evaluator
from uqfold.methods import session_file
from uqfold.methods.arguments import CriteriaLike, checked_criteria, checked_problem
from uqfold.methods.ask_tell_session import AskTellSession
from uqfold.methods.seeding import RandomSource
from uqfold.methods.steps import SteppedMethod, Steps
from uqfold.problems.base import Problem

__all__ = ["AskTellSession", "SequentialMethod", "Steps"]


@dataclass(frozen=True)
class SequentialMethod(SteppedMethod):
    """A method that asks for evaluations step by step, here or outside.

    A subclass fills in the generator `_steps`; see `SteppedMethod`.
    """

    @final
    def start(
        self,
        problem: Problem,
        criteria: CriteriaLike = None,
        *,
        max_evals: int | None = None,
        rng: RandomSource = None,
        evaluator: Evaluator | None = None,
    ) -> AskTellSession:
        """Start an estimate whose evaluations the caller makes.

        Parameters as in `estimate`. The problem's own model is never called; of the evaluator,
        the policy for failed runs and the progress display are used.

        Returns
        -------
        AskTellSession
            Ask it for rows, tell it their responses, and take its result when it is done.
        """
        return AskTellSession(self, problem, criteria, max_evals, rng, evaluator)

    @final
    def resume(
        self,
        path: str | PathLike[str],
        problem: Problem,
        criteria: CriteriaLike = None,
        *,
        max_evals: int | None = None,
        rng: RandomSource = None,
        evaluator: Evaluator | None = None,
    ) -> AskTellSession:
        """Go on with a session saved by `AskTellSession.save`, by replaying its responses.

        Parameters
        ----------
        path
            The file.
        problem, criteria, evaluator
            As in `start`; they are compared with what the file recorded.
        max_evals, rng
            None takes both from the file. Other values must be those of the file.

        Raises
        ------
        SessionFileError
            If the file is damaged, is not a session file, or belongs to another method, problem,
            criteria, budget, seed or policy for failed runs.
        """
        checked_problem(problem)
        checked_criteria(problem, criteria)
        saved = session_file.read(checked_path("path", path))
        if max_evals is None:
            max_evals = saved.header["max_evals"]
        session = self.start(
            problem,
            criteria,
            max_evals=max_evals,
            rng=saved.header["seed"] if rng is None else rng,
            evaluator=evaluator,
        )
        saved.check_belongs_to(session.header())
        session.replay(saved)
        return session
