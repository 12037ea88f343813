"""How often intervals hold the truth, and how large errors are against the stated ones.

Every stochastic method answers the same questions with many seeds, on systems whose answer is
known: methods that sample on a linear one, those that fit a surface on a curved one, since a linear
response is fitted exactly and says nothing of the error of a surface. Both numbers come with the
error of so many repeats.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from uqfold.methods import available
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.testing.curved import CurvedSystem
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.validation import Finding, Measurement, Table, Work

SYSTEM = LinearNormalSystem(units=3, shared_std=0.5)
QUESTIONS = {
    "body": Criterion(11.0),
    "pf near 0.01": Criterion(13.0),
    "tau": Criterion(13.0, 3.5),
    "random missions": Criterion(12.5, None, Binomial(4, 0.7)),
}

CURVED = CurvedSystem()
CURVED_QUESTIONS = {
    "curved, body": Criterion(12.0),
    "curved, pf near 0.02": Criterion(13.5),
}

EVALS = 6_000
"""Runs of a method that samples; surrogates take as few as they like."""

LEAST = 0.9
"""Least coverage of an interval that is called a 95 % interval."""

MOST = 1.25
"""Most that errors may exceed the stated ones, root mean square."""

TOO_SURE = "surfaces too sure"
"""Fault of methods that fit a surface."""

TWO = 2.0
"""Standard errors on either side of an empirical number."""


def methods() -> dict[str, ReliabilityMethod]:
    """Every registered method that is stochastic, with its default settings."""
    built = {name: method() for name, method in available().items()}
    return {name: method for name, method in built.items() if method.stochastic}


def repeat(name: str, seed: int) -> list[list[float | None]]:
    """One run: for each question pf, standard error, both ends, and whether it states sampling."""
    system = CURVED if _fits(name) else SYSTEM
    asked = list(questions(name).values())
    result = methods()[name].estimate(system.problem(), asked, max_evals=EVALS, rng=seed)
    return [
        [None] * 4 if row.status in NO_ANSWER else [row.pf, row.std_error, row.ci_low, row.ci_high]
        for row in result
    ]


def run_block(name: str, seeds: range) -> Any:
    """Repeats of one method."""
    return {"kind": _error_kind(name), "repeats": [repeat(name, seed) for seed in seeds]}


def _error_kind(name: str) -> str:
    row = methods()[name].estimate(SYSTEM.problem(), QUESTIONS["body"], max_evals=EVALS, rng=0)[0]
    return row.error_kind


def questions(name: str) -> dict[str, Criterion]:
    """What a method is asked."""
    return CURVED_QUESTIONS if _fits(name) else QUESTIONS


def exact_pf(name: str, question: str) -> float:
    """The exact answer to what a method is asked."""
    criterion = questions(name)[question]
    return CURVED.pf(criterion.threshold) if _fits(name) else SYSTEM.pf(criterion)


def summary(name: str, kind: str, question: str, repeats: list[Any]) -> dict[str, Any] | None:
    """Coverage, and ratio of empirical and stated errors, with two standard errors each."""
    index = list(questions(name)).index(question)
    rows = [row[index] for row in repeats if row[index][0] is not None]
    if not rows:
        return None
    exact = exact_pf(name, question)
    inside = [low <= exact <= high for _, _, low, high in rows]
    coverage, n = float(np.mean(inside)), len(rows)
    # Agresti and Coull: a spread also where every interval holds the truth
    guess = (sum(inside) + 2.0) / (n + 4.0)
    z = np.array([(pf - exact) / error for pf, error, _, _ in rows if error and error > 0.0])
    ratio = float(np.sqrt(np.mean(z**2))) if len(z) else math.nan
    return {
        "method": name,
        "error kind": kind,
        "question": question,
        "exact pf": exact,
        "repeats": n,
        "coverage (%)": 100.0 * coverage,
        "its two standard errors (%)": 100.0 * TWO * math.sqrt(guess * (1.0 - guess) / (n + 4.0)),
        "empirical over stated error": ratio,
        "its relative two standard errors": _ratio_error(z),
        "mean error (stated errors)": float(z.mean()) if len(z) else math.nan,
    }


def _ratio_error(z: Any) -> float:
    """Two standard errors of the root mean square of z, relative, by the delta method."""
    if len(z) < 2:
        return math.nan
    squares = z**2
    spread = float(squares.std(ddof=1)) / math.sqrt(len(z))
    return TWO * spread / (2.0 * float(squares.mean()))


def judge(row: dict[str, Any]) -> list[Finding]:
    """Judge one method on one question; a surrogate may overstate its error, none understate."""
    name = f"{row['method']}, {row['question']}"
    return [
        Finding(
            f"{name}: coverage", row["coverage (%)"], 100.0 * LEAST, "%", at_least=True,
            uncertainty=row["its two standard errors (%)"],
        ),
        Finding(
            f"{name}: empirical over stated error", row["empirical over stated error"], MOST,
            uncertainty=row["empirical over stated error"]
            * row["its relative two standard errors"],
        ),
    ]  # fmt: skip


def measure(work: Work) -> Measurement:
    """Repeat 100, 400 or 4,000 times.

    Methods that fit a surface have 10 repeats in the default tier and 100 in the full one; with
    their fault planted, the fastest of them has 8.
    """
    first = work.seeds[0]
    samplers, fitters = work.pick(100, 400, 4_000), work.pick(0, 10, 100)
    counts = {name: fitters if _fits(name) else samplers for name in methods()}
    if work.fault == TOO_SURE:
        counts = {"pce": 8}
    plan = {}
    for name, n in counts.items():
        blocks = [range(first + i, first + min(i + 50, n)) for i in range(0, n, 50)]
        plan |= {
            f"{name}, seeds {block[0]} on": partial(run_block, name, block) for block in blocks
        }
    found = work.parts(plan)
    rows = []
    for name in counts:
        blocks = [block for key, block in found.items() if key.startswith(f"{name}, seeds")]
        repeats = [_planted(one, work.fault) for block in blocks for one in block["repeats"]]
        for question in questions(name) if repeats else ():
            row = summary(name, blocks[0]["kind"], question, repeats)
            if row is not None:
                rows.append(row)
    findings = [finding for row in rows for finding in judge(row)]
    table = Table.of("Intervals of 95 %, and errors against the stated ones", rows)
    return Measurement(findings, [table])


def _fits(name: str) -> bool:
    """Whether a method fits a surface, which takes seconds."""
    from uqfold.methods.ask_tell import SequentialMethod

    return isinstance(methods()[name], SequentialMethod)


def _planted(rows: list[list[Any]], fault: str | None) -> list[list[Any]]:
    if fault is None:
        return rows
    changed = []
    for pf, error, low, high in rows:
        if pf is None:
            changed.append([pf, error, low, high])
        elif fault == TOO_SURE:
            middle = 0.5 * (low + high)
            near = [middle + 0.01 * (end - middle) for end in (low, high)]
            changed.append([pf, 0.01 * error, *near])
        elif fault == "overconfident":
            middle = 0.5 * (low + high)
            changed.append([pf, 0.5 * error, 0.5 * (low + middle), 0.5 * (high + middle)])
        else:
            shift = 2.0 * error
            changed.append([pf + shift, error, low + shift, high + shift])
    return changed
