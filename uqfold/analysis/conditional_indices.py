"""Sobol' indices of dependent inputs that do not depend on the order of the columns.

The main index of an input is the share of the variance that its value alone explains, whatever it
brings along of the others; the total index is the share that is left once all others are known. A
Rosenblatt transformation that starts with an input has the first as a plain Sobol' index, one that
ends with it the second. So the inputs are turned about within each dependent part until each has
been first and last. With dependent inputs a total index may lie below the main one.

References
----------
Kucherenko S., Tarantola S., Annoni P. Estimation of global sensitivity indices for models with
dependent variables. Comput. Phys. Commun. 183 (2012) 937-946.
Mara T. A., Tarantola S. Variance-based sensitivity indices for models with dependent inputs.
Reliab. Eng. Syst. Saf. 107 (2012) 115-121.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from uqfold.analysis.affordable import check_affordable
from uqfold.analysis.exchanged_columns import (
    checked_samples,
    frozen_rows,
    responses_with_variance,
    saltelli,
    standard_pairs,
)
from uqfold.analysis.sobol_rows import SobolIndices, labelled_rows, student_quantile
from uqfold.checks import whole
from uqfold.evaluation import Evaluator
from uqfold.inputs import JointInputs
from uqfold.methods.arguments import checked_budget, checked_evaluator, checked_unit
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.problems.base import Problem
from uqfold.typing import FloatArray

CONDITIONAL = "conditional"


@dataclass(frozen=True)
class _Ordering:
    """The inputs in one order of the transformation, and what is read off it.

    Attributes
    ----------
    inputs
        The inputs in that order.
    order
        Which input (d,) of the problem stands at each place.
    frozen
        Columns that are exchanged together.
    main, total
        For each of them the row of the result that its main and its total index is, or None;
        the group of all shared inputs is row d of the main ones.
    """

    inputs: JointInputs
    order: tuple[int, ...]
    frozen: list[tuple[int, ...]] = field(default_factory=list)
    main: list[int | None] = field(default_factory=list)
    total: list[int | None] = field(default_factory=list)

    def read(self, columns: tuple[int, ...], main: int | None, total: int | None) -> None:
        """Note what to read off an exchange of some columns."""
        self.frozen.append(columns)
        self.main.append(main)
        self.total.append(total)

    @property
    def points(self) -> int:
        """Rows for each sample: A, B, and A with each of the exchanges."""
        return 2 + len(self.frozen)

    def rows(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Inputs X, columns as the problem has them, of standard-normal samples A and B."""
        x = self.inputs.from_standard_normal(frozen_rows(a, b, self.frozen))
        back = np.empty(x.shape)
        back[:, self.order] = x
        return back


def conditional_sobol(
    problem: Problem,
    samples: int = 1024,
    repetitions: int = 8,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> SobolIndices:
    """Estimate Sobol' indices of dependent inputs, whatever their order, by running the model.

    Independent inputs get the same numbers as from `pick_freeze`.

    Parameters
    ----------
    problem
        Model and inputs, d of them.
    samples
        Size of the samples A and B, a power of two: Sobol' sequences, scrambled anew for each
        repetition.
    repetitions
        Independent repetitions, at least 3; their spread is the error. Each takes up to
        ``4 samples`` runs for each input of the largest dependent part, and more for others.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`; a budget must pay for all runs.

    Returns
    -------
    SobolIndices
        ``main``: Var E[y | x_i] / Var y; ``total``: E Var[y | all but x_i] / Var y.

    Raises
    ------
    ValueError
        For wrong arguments, if a response is infinite or a run fails (there is no variance), or
        if the dependence is known in one order only.
    BudgetExceededError
        If the runs cost more than `max_evals`; none is made then.
    """
    started = time.perf_counter()
    checked_unit(problem)
    samples = checked_samples(samples)
    repetitions = whole("repetitions", repetitions, at_least=3)
    seed = reduced_seed(rng)
    views = list(_views(problem.inputs))
    session = checked_evaluator(evaluator).open(problem, checked_budget(max_evals))
    session.expected = repetitions * samples * sum(view.points for view in views)
    check_affordable(session, session.expected)
    found, moments = [], []
    for block in range(repetitions):
        a, b = standard_pairs(samples, problem.inputs.dimension, block_generator(seed, block))
        read = _Read(problem.inputs)
        for view in views:
            y = responses_with_variance(session, view.rows(a, b))
            read.off(view, y)
        found.append(read.values)
        both = read.both
        moments.append((both.mean(), both.std()))
    values = np.array(found)
    mean, std = np.mean(moments, axis=0)
    return SobolIndices(
        rows=labelled_rows(
            problem.inputs, values.mean(axis=0),
            values.std(axis=0, ddof=1) / math.sqrt(repetitions),
            student_quantile(repetitions - 1), "sampling", CONDITIONAL, problem.inputs.names,
        ),
        mean=float(mean),
        std=float(std),
        n_evals=session.n_evals,
        n_reused=session.n_reused,
        seconds=time.perf_counter() - started,
        seed=seed,
    )  # fmt: skip


class _Read:
    """Indices of one repetition, collected from the views."""

    def __init__(self, inputs: JointInputs) -> None:
        d = inputs.dimension
        self._main = np.full(d + int(inputs.shared_are_a_group), np.nan)
        self._total = np.full(d, np.nan)
        self.both: FloatArray = np.empty(0)

    def off(self, view: _Ordering, y: FloatArray) -> None:
        """Read what one view tells."""
        table = y.reshape(view.points, -1)
        if not self.both.size:
            self.both = table[:2].ravel()
        main, total = saltelli(table)
        for i, (to_main, to_total) in enumerate(zip(view.main, view.total, strict=True)):
            if to_main is not None:
                self._main[to_main] = main[i]
            if to_total is not None:
                self._total[to_total] = total[i]

    @property
    def values(self) -> FloatArray:
        """Main indices, that of the group if there is one, then total indices."""
        return np.concatenate([self._main, self._total])


def _views(inputs: JointInputs) -> Iterator[_Ordering]:
    """Orders in which each input is once the first and once the last of its dependent part."""
    parts = [part.columns for part in inputs.parts.dependent]
    linked = {column for part in parts for column in part}
    first = _Ordering(inputs, tuple(range(inputs.dimension)))
    for i in range(inputs.dimension):
        if i not in linked:
            first.read((i,), i, i)
    for part in parts:
        first.read((part[0],), part[0], None)
        first.read((part[-1],), None, part[-1])
    if inputs.shared_are_a_group:
        first.read(tuple(range(inputs.n_shared)), inputs.dimension, None)
    yield first
    for turn in range(1, max(map(len, parts), default=1)):
        order = list(range(inputs.dimension))
        turned = [part for part in parts if turn < len(part)]
        for part in turned:
            for place, column in enumerate(part):
                order[column] = part[(place + turn) % len(part)]
        view = _Ordering(inputs.in_order(order), tuple(order))
        for part in turned:
            view.read((part[0],), order[part[0]], None)
            view.read((part[-1],), None, order[part[-1]])
        yield view
