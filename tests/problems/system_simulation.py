"""Plain simulation of a problem's system, straight from its definition."""

import numpy as np

from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion


def simulated_failures(
    problem: Problem, criteria: list[Criterion], systems: int, seed: int
) -> np.ndarray:
    """Which systems fail each criterion: booleans (criteria, systems).

    The inputs are drawn marginal by marginal from numpy's normal generator, so that neither the
    project's sampling nor its system algebra takes part.
    """
    rng = np.random.default_rng(seed)
    mean = [m.getMean()[0] for m in problem.inputs.marginals]
    std = [m.getStandardDeviation()[0] for m in problem.inputs.marginals]
    n_shared = problem.inputs.n_shared
    shared = rng.standard_normal((systems, n_shared))
    most = max(criterion.max_missions for criterion in criteria)
    flown = {
        c: rng.binomial(c.missions.planned, c.missions.p, systems)
        if isinstance(c.missions, Binomial)
        else np.full(systems, c.missions)
        for c in criteria
    }
    failed = np.zeros((len(criteria), systems), dtype=bool)
    for mission in range(most):
        y = np.empty((problem.n_units, systems))
        for unit in range(problem.n_units):
            own = rng.standard_normal((systems, problem.inputs.n_individual))
            y[unit] = problem.model(np.column_stack([shared, own]) * std + mean)
        last, spread = y.max(axis=0), np.ptp(y, axis=0)
        for i, c in enumerate(criteria):
            works = last <= c.threshold
            if c.tau is not None:
                works &= spread <= c.tau
            failed[i] |= ~works & (mission < flown[c])
    return failed


def z_scores(problem: Problem, criteria: list[Criterion], systems: int, seed: int) -> np.ndarray:
    """How far simulation lies from the problem's references, in its own standard errors."""
    failed = simulated_failures(problem, criteria, systems, seed)
    assert problem.references is not None
    references = [problem.references.lookup(criterion) for criterion in criteria]
    pf = np.array([reference.pf for reference in references if reference is not None])
    return (failed.mean(axis=1) - pf) / np.sqrt(pf * (1 - pf) / systems)
