"""A fitted process seen through a question: its answers, their error, and where to learn more."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.evaluation import RunningEstimate
from uqfold.methods.active_question import Question, flown
from uqfold.methods.limit_cloud import limit_cloud
from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.surrogates.importance_cloud import ImportanceCloud, resampled
from uqfold.surrogates.learning import Candidates
from uqfold.surrogates.posterior_covariance import PosteriorCovariance
from uqfold.typing import FloatArray

FARTHEST_BETA = 8.0
"""Reliability indices beyond this are treated as this: 6e-16, no more to be learned there."""

_NODES = 800
_CANDIDATES = 400
_FRESH = 8192
_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class View:
    """A fitted process seen through the question: answers, their uncertainty, where to learn.

    Attributes
    ----------
    process
        The process.
    question
        The question.
    pf
        Failure probabilities (C,).
    beta, beta_std
        Their reliability indices, cut at +-FARTHEST_BETA, and the standard deviations (C,) of
        these that the posterior covariance of the process implies, to first order.
    shift
        Change (C,) of the indices if the whole surface were shifted by one unit of the response.
    u, importance
        Points (N, d) of a cloud, and the share (N,) that each of them has in the answers.
    nodes, node_influence
        Points (J, d) and the influence (C, J) of the surface's values there on the indices.
    covariance
        Posterior covariance of the process.
    """

    process: GaussianProcess
    question: Question
    pf: FloatArray
    beta: FloatArray
    beta_std: FloatArray
    shift: FloatArray
    u: FloatArray
    importance: FloatArray
    nodes: FloatArray
    node_influence: FloatArray
    covariance: PosteriorCovariance

    @classmethod
    def of(cls, process: GaussianProcess, question: Question, rng: np.random.Generator) -> View:
        """Look at a process."""
        answers = question.answers(process.mean)
        cloud, influence = limit_cloud(
            process.mean, process.std, float(process.y.std()), answers, rng
        )
        pf = _sampled(process, question, cloud, rng) if answers.pf is None else answers.pf
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
        node_influence = weighted[:, picked] / share / density[:, None]
        nodes, covariance = cloud.u[picked], PosteriorCovariance(process)
        spread = ((node_influence @ covariance(nodes, nodes)) * node_influence).sum(axis=1)
        return cls(
            process=process,
            question=question,
            pf=pf,
            beta=beta,
            beta_std=np.sqrt(np.maximum(spread, 0.0)),
            shift=np.abs(weighted).sum(axis=1) / density,
            u=cloud.u,
            importance=importance,
            nodes=nodes,
            node_influence=node_influence,
            covariance=covariance,
        )

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
        change = self.process.mean(self.nodes) - earlier.process.mean(self.nodes)
        return np.asarray(np.abs(self.node_influence @ change))

    def candidates(self, rng: np.random.Generator) -> tuple[FloatArray, Candidates]:
        """Draw points (M, d) that may be run next, from where the surface matters."""
        uncertain = self.importance * self.process.std(self.u)
        half = _CANDIDATES // 2
        picked = np.concatenate(
            [resampled(self.importance, half, rng), resampled(uncertain, half, rng)]
        )
        u = self.u[np.unique(picked)]
        return u, Candidates(
            mean=self.process.mean(u),
            covariance=self.covariance(u, u),
            with_answers=self.covariance(u, self.nodes) @ self.node_influence.T,
            levels=self.question.levels,
            noise_variance=self.covariance.noise_variance,
        )


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
        z = (mean - criterion.threshold) / std
        late, early = float(weights @ ndtr(z)), float(weights @ ndtr(-z))
        # the weights sum to one only roughly: the smaller probability is the accurate one
        single = late if late < early else max(0.0, 1.0 - early)
        found.append(flown(criterion) * min(single, 1.0))
    return np.array(found)
