"""Fitted processes seen through a question: answers, their error, and where to learn more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.evaluation import RunningEstimate
from uqfold.methods.active_question import Answers, Question, flown
from uqfold.methods.limit_cloud import limit_cloud
from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.surrogates.importance_cloud import ImportanceCloud, resampled
from uqfold.surrogates.learning import Candidates, LearningFunction
from uqfold.surrogates.posterior_covariance import PosteriorCovariance
from uqfold.typing import FloatArray

FARTHEST_BETA = 8.0
"""Reliability indices beyond this are treated as this: 6e-16, no more to be learned there."""

_NODES = 800
_CANDIDATES, _FEWEST_CANDIDATES = 400, 100
_FRESH = 8192
# Share of a standard deviation that is none.
_SURE = 1e-3
_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class KindView:
    """The process of one kind of units, and where the answers hang on it.

    Attributes
    ----------
    process
        The process.
    answers
        How the answers hang on its surface.
    pf
        Failure probabilities (C,) of the system.
    shift
        Change (C,) of their reliability indices if the whole surface were shifted by one unit of
        the response.
    u, importance
        Points (N, d) of a cloud, and the share (N,) that each of them has in the answers.
    nodes, node_influence
        Points (J, d) and the influence (C, J) of the surface's values there on the indices.
    covariance
        Posterior covariance of the process.
    """

    process: GaussianProcess
    answers: Answers
    pf: FloatArray
    shift: FloatArray
    u: FloatArray
    importance: FloatArray
    nodes: FloatArray
    node_influence: FloatArray
    covariance: PosteriorCovariance

    def hidden(self, factor: float, rng: np.random.Generator) -> FloatArray:
        """How far the indices (C,) move if responses err by so many times what is stated of them.

        To first order: what may lie on the other side of a threshold, however far from all known
        failures, less what the process itself says of it.
        """
        process, centre = self.process, np.zeros((1, self.answers.dimension))
        cloud, _ = _cloud(process, self.answers, factor, rng)
        u, weights = cloud.fresh(_FRESH, rng)
        mean, std = process.mean_and_std(u)
        there = float(process.mean(centre)[0])
        sure, unsure = (
            self.answers.beyond(u, mean, share * std, there) @ weights for share in (_SURE, factor)
        )
        return np.asarray(np.abs(unsure - sure) / _index(self.pf)[1])

    @property
    def spread(self) -> FloatArray:
        """Variances (C,) of the indices that the posterior of the process implies."""
        covariance = self.covariance(self.nodes, self.nodes)
        found = ((self.node_influence @ covariance) * self.node_influence).sum(axis=1)
        return np.asarray(np.maximum(found, 0.0))

    def candidates(self, most: int, rng: np.random.Generator) -> tuple[FloatArray, Candidates]:
        """Draw points (at most `most`, d) that may be run next, from where the surface matters."""
        uncertain = self.importance * self.process.std(self.u)
        half = most // 2
        picked = np.concatenate(
            [resampled(self.importance, half, rng), resampled(uncertain, half, rng)]
        )
        u = self.u[np.unique(picked)]
        return u, Candidates(
            mean=self.process.mean(u),
            covariance=self.covariance(u, u),
            with_answers=self.covariance(u, self.nodes) @ self.node_influence.T,
            levels=np.tile(self.answers.levels, (len(u), 1)),
            noise_variance=np.full(len(u), self.covariance.noise_variance),
        )


@dataclass(frozen=True, eq=False)
class View:
    """Fitted processes seen through the question: answers, their uncertainty, where to learn.

    Attributes
    ----------
    kinds
        The process of each kind of units.
    question
        The question.
    pf
        Failure probabilities (C,).
    beta, beta_std
        Their reliability indices, cut at +-FARTHEST_BETA, and the standard deviations (C,) of
        these that the posterior covariances of the processes imply, to first order.
    """

    kinds: tuple[KindView, ...]
    question: Question
    pf: FloatArray
    beta: FloatArray
    beta_std: FloatArray

    @classmethod
    def of(
        cls,
        processes: Sequence[GaussianProcess],
        question: Question,
        rng: np.random.Generator,
        factors: Sequence[float] | None = None,
    ) -> View:
        """Look at the process of each kind; its error is so many times what it states."""
        pf, answers = question.answers([one.mean for one in processes])
        kinds: list[KindView] = []
        factors = [1.0] * len(answers) if factors is None else factors
        for process, own, factor in zip(processes, answers, factors, strict=True):
            cloud, influence = _cloud(process, own, factor, rng)
            if pf is None:
                pf = _sampled(process, question, cloud, rng)
            beta, density = _index(pf)
            weighted = influence * cloud.weights
            total = np.abs(weighted).sum(axis=1, keepdims=True)
            some = total[:, 0] > 0.0
            if some.any():
                importance = (np.abs(weighted[some]) / total[some]).mean(axis=0)
            else:
                importance = cloud.weights / cloud.weights.sum()
            picked = resampled(importance, _NODES, rng)
            share = _NODES * importance[picked] / importance.sum()
            kind = KindView(
                process=process,
                answers=own,
                pf=pf,
                shift=total[:, 0] / density,
                u=cloud.u,
                importance=importance,
                nodes=cloud.u[picked],
                node_influence=weighted[:, picked] / share / density[:, None],
                covariance=PosteriorCovariance(process),
            )
            kinds.append(kind)
        spread = np.sum([kind.spread for kind in kinds], axis=0)
        return cls(tuple(kinds), question, kinds[0].pf, beta, np.sqrt(spread))

    @property
    def runs(self) -> int:
        """Training runs, of all kinds together."""
        return sum(kind.process.y.size for kind in self.kinds)

    def running(self) -> RunningEstimate:
        """Return the state of the criterion that is least certain so far."""
        from scipy.special import ndtr

        worst = int(np.argmax(self.beta_std))
        beta, spread = self.beta[worst], 2.0 * self.beta_std[worst]
        return RunningEstimate(
            criterion=str(self.question.criteria[worst]),
            pf=float(self.pf[worst]),
            ci_low=float(ndtr(-beta - spread)),
            ci_high=float(ndtr(-beta + spread)),
        )

    def moved_since(self, earlier: View) -> FloatArray:
        """How far the indices (C,) have moved since an earlier view, to first order."""
        moves = [
            kind.node_influence @ (kind.process.mean(kind.nodes) - before.process.mean(kind.nodes))
            for kind, before in zip(self.kinds, earlier.kinds, strict=True)
        ]
        return np.asarray(np.abs(np.sum(moves, axis=0)))

    def next_runs(
        self, learning: LearningFunction, size: int, rng: np.random.Generator
    ) -> list[FloatArray]:
        """Choose points (k, d) of each kind, `size` in all or fewer, that teach most together."""
        most = max(_FEWEST_CANDIDATES, _CANDIDATES // len(self.kinds))
        u, candidates = zip(*(kind.candidates(most, rng) for kind in self.kinds), strict=True)
        chosen = np.array(Candidates.of_all(candidates).batch(learning, size), dtype=np.int64)
        ends = np.cumsum([len(points) for points in u])
        return [
            points[chosen[(chosen >= end - len(points)) & (chosen < end)] - end + len(points)]
            for points, end in zip(u, ends.tolist(), strict=True)
        ]


def _cloud(
    process: GaussianProcess, answers: Answers, factor: float, rng: np.random.Generator
) -> tuple[ImportanceCloud, FloatArray]:
    """Draw a cloud that follows the influence of a process whose error is so many times its own."""

    def std(u: FloatArray) -> FloatArray:
        return factor * process.std(u)

    return limit_cloud(process.mean, std, float(process.y.std()), answers, rng)


def _index(pf: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Reliability indices and the normal density there."""
    from scipy.special import ndtri

    beta = np.clip(-ndtri(pf), -FARTHEST_BETA, FARTHEST_BETA)
    return beta, np.exp(-0.5 * beta**2) / _ROOT_TWO_PI


def _sampled(
    process: GaussianProcess, question: Question, cloud: ImportanceCloud, rng: np.random.Generator
) -> FloatArray:
    """Failure probabilities (C,) by importance sampling, averaged over the posterior."""
    from scipy.special import ndtr

    u, weights = cloud.fresh(_FRESH, rng)
    mean, std = process.mean_and_std(u)
    found = []
    for criterion in question.criteria:
        with np.errstate(over="ignore"):
            z = (mean + question.units.shift - criterion.threshold) / std
        late, early = float(weights @ ndtr(z)), float(weights @ ndtr(-z))
        # the weights sum to one only roughly: the smaller probability is the accurate one
        single = late if late < early else max(0.0, 1.0 - early)
        found.append(flown(criterion) * min(single, 1.0))
    return np.array(found)
