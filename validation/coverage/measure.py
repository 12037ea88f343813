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

import pandas as pd

from uqfold.methods import available
from uqfold.methods.ask_tell import SequentialMethod
from uqfold.methods.base import ReliabilityMethod
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.reference import Reference
from uqfold.testing.curved import CurvedSystem
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import answers, rms

SYSTEM = LinearNormalSystem(units=3, shared_std=0.5)
CURVED = CurvedSystem()
QUESTIONS = {
    "body": Criterion(11.0),
    "pf near 0.01": Criterion(13.0),
    "tau": Criterion(13.0, 3.5),
    "random missions": Criterion(12.5, None, Binomial(4, 0.7)),
}
KNOWN = {name: Reference(one, SYSTEM.pf(one), 0.0) for name, one in QUESTIONS.items()}
"""Questions to methods that sample, with their answers."""
CURVED_KNOWN = {
    name: Reference(Criterion(threshold), CURVED.pf(threshold), 0.0)
    for name, threshold in (("curved, body", 12.0), ("curved, pf near 0.02", 13.5))
}
"""Questions to methods that fit a surface, with their answers."""
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
    """Return every registered method that is stochastic, with its default settings."""
    built = {name: method() for name, method in available().items()}
    return {name: method for name, method in built.items() if method.stochastic}


def fits(method: ReliabilityMethod) -> bool:
    """Whether a method fits a surface, which takes seconds."""
    return isinstance(method, SequentialMethod)


def repeats(name: str, seeds: range) -> pd.DataFrame:
    """Ask one method all its questions with many seeds; what it does not answer is left out."""
    method = methods()[name]
    problem, asked = (CURVED, CURVED_KNOWN) if fits(method) else (SYSTEM, KNOWN)
    ask = partial(answers, method, problem.problem(), [*asked.values()], max_evals=EVALS)
    rows = pd.concat([ask(seed=seed).assign(question=[*asked]) for seed in seeds])
    return rows[rows["pf"].notna()]


def summary(name: str, question: str, rows: pd.DataFrame) -> dict[str, Any]:
    """Return coverage, and ratio of empirical and stated errors, with two standard errors each."""
    inside, n = rows["known"].between(rows["ci_low"], rows["ci_high"]), len(rows)
    # Agresti and Coull: a spread also where every interval holds the truth
    guess = (inside.sum() + 2.0) / (n + 4.0)
    z = rows["z"].dropna()
    squares = z**2
    # of the root mean square of z, by the delta method
    spread = squares.std() / math.sqrt(max(len(z), 1)) / (2.0 * squares.mean())
    return {
        "method": name,
        "error kind": rows["error_kind"].iloc[0],
        "question": question,
        "exact pf": rows["known"].iloc[0],
        "repeats": n,
        "coverage (%)": 100.0 * inside.mean(),
        "its two standard errors (%)": 100.0 * TWO * math.sqrt(guess * (1.0 - guess) / (n + 4.0)),
        "empirical over stated error": rms(z),
        "its relative two standard errors": TWO * spread,
        "mean error (stated errors)": z.mean(),
    }


def judge(row: dict[str, Any]) -> list[Finding]:
    """Judge one method on one question; a surrogate may overstate its error, none understate."""
    name, ratio = f"{row['method']}, {row['question']}", row["empirical over stated error"]
    return [
        Finding(f"{name}: coverage", row["coverage (%)"], 100.0 * LEAST, "%", at_least=True,
                uncertainty=row["its two standard errors (%)"]),
        Finding(f"{name}: empirical over stated error", ratio, MOST,
                uncertainty=ratio * row["its relative two standard errors"]),
    ]  # fmt: skip


def planted(rows: pd.DataFrame, fault: str | None) -> pd.DataFrame:
    """Return answers with intervals and errors that a fault has made narrower, or moved."""
    if fault == "biased":
        shift = 2.0 * rows["std_error"]
        return rows.assign(
            ci_low=rows["ci_low"] + shift, ci_high=rows["ci_high"] + shift, z=rows["z"] + 2.0
        )
    narrower = {None: 1.0, "overconfident": 0.5, TOO_SURE: 0.01}[fault]
    middle = 0.5 * (rows["ci_low"] + rows["ci_high"])
    low, high = (middle + narrower * (rows[end] - middle) for end in ("ci_low", "ci_high"))
    return rows.assign(ci_low=low, ci_high=high, z=rows["z"] / narrower)


def measure(work: Work) -> Measurement:
    """Repeat 100, 400 or 4,000 times.

    Methods that fit a surface have 10 repeats in the default tier and 100 in the full one; with
    their fault planted, the fastest of them has 8.
    """
    first = work.seeds[0]
    samplers, fitters = work.pick(100, 4_000), work.pick(0, 100)
    counts = {name: fitters if fits(method) else samplers for name, method in methods().items()}
    if work.fault == TOO_SURE:
        counts = {"pce": 8}
    found = work.parts(
        {
            name: partial(repeats, name, range(first, first + n))
            for name, n in counts.items()
            if n > 0
        }
    )
    rows = [
        summary(name, str(question), own)
        for name, answered in found.items()
        for question, own in planted(answered, work.fault).groupby("question", sort=False)
    ]
    findings = [finding for row in rows for finding in judge(row)]
    table = Table.of("Intervals of 95 %, and errors against the stated ones", rows)
    return Measurement(findings, [table])
