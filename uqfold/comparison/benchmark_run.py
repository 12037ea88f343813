"""Methods x problems x seeds: answer each question once, keep the answers, go on where it ended."""

from __future__ import annotations

import concurrent.futures
import hashlib
import json
import math
import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from uqfold.checks import choice, function, instance, listed, or_none, refused, text, whole
from uqfold.checks import path as checked_path
from uqfold.comparison.benchmark_rows import (
    ROWS_NAME,
    SCHEMA,
    append_rows,
    benchmark_frame,
    read_benchmark,
)
from uqfold.comparison.columns import comparison_row
from uqfold.comparison.header import header_of, source_of
from uqfold.comparison.named_problems import available_problems, named_problem
from uqfold.comparison.possible_rows import criterion_of
from uqfold.comparison.run import Methods, labelled_methods
from uqfold.evaluation import Evaluator
from uqfold.evaluation.deadline import limit_told
from uqfold.evaluation.worker import follow_parent
from uqfold.methods.arguments import checked_budget, checked_criteria
from uqfold.methods.base import ReliabilityMethod
from uqfold.problems.base import Problem
from uqfold.problems.catalogue.folder import titles
from uqfold.problems.criterion import Criterion
from uqfold.provenance import now

if TYPE_CHECKING:
    import pandas as pd

ProblemLike: TypeAlias = str | Problem
Problems: TypeAlias = ProblemLike | Iterable[ProblemLike] | None
Workers: TypeAlias = int | concurrent.futures.Executor
BenchmarkProgress: TypeAlias = Callable[[int, int], None]
"""Called with (answers there are, answers asked for), first as the work begins."""
Rows: TypeAlias = list[dict[str, Any]]


class _Question(NamedTuple):
    problem: str
    label: str
    seed: int


def benchmark(
    methods: Methods = None,
    problems: Problems = None,
    seeds: int | Iterable[int] = 3,
    *,
    max_evals: int | None = 6_000,
    path: str | os.PathLike[str] | None = None,
    workers: Workers = 1,
    max_seconds: float | None = None,
    progress: BenchmarkProgress | None = None,
    command: str = "",
) -> pd.DataFrame:
    """Ask many methods about many problems with many seeds, and set the answers beside references.

    Every problem is asked for its own default criteria. A method that gives the same answer with
    every seed is asked once, with the first of them.

    Parameters
    ----------
    methods
        As for `uqfold.compare`; None: every available method with its default settings.
    problems
        Names (`uqfold.comparison.available_problems`, ``FILE.py:FUNCTION``, ``FILE.toml``) or
        problems with references; None: all limit states of the catalogue.
    seeds
        How many seeds, counted from zero, or the seeds themselves.
    max_evals
        Most evaluations for an answer; None: as many as the settings of the methods ask for.
    path
        A file, or the folder of a file ``rows.jsonl``: every answer is appended at once, as a line
        of JSON for each criterion. What is there already is not asked again, unless it was made by
        other code or settings, the problem has changed, or a shorter `max_seconds` ended it: the
        same call goes on where an earlier one was interrupted.
    workers
        Number of processes, or an executor of `concurrent.futures` that stays the caller's, such as
        ``distributed.Client(...).get_executor()``. It has no influence on any number but times.
    max_seconds
        Wall-clock limit of each answer. What it ends depends on the machine.
    progress
        Called with (answers there are, answers asked for).
    command
        What is running, kept with every row.

    Returns
    -------
    pandas.DataFrame
        One row per problem, method, seed and criterion: the columns of `uqfold.compare`, then
        ``max_evals``, ``inputs`` (number of random inputs), ``covered`` (whether the interval holds
        the reference, widened by two of its standard errors), ``settings``, ``code`` (digest of
        source, versions and problem), ``date`` and ``command``. `uqfold.comparison.league_table`
        and `problem_scores` sum it up, `uqfold.plots.performance_profile` and `data_profile` draw.

    Raises
    ------
    ValueError, TypeError
        For an unknown name or a wrong argument, before any run is spent.
    uqfold.comparison.RecordsError
        If the file holds something else.

    Examples
    --------
    >>> import uqfold
    >>> frame = uqfold.benchmark(["openturns-form", "sorm"], ["rp107"], seeds=1)
    >>> frame[["problem", "label"]].to_numpy().tolist()
    [['rp107', 'openturns-form'], ['rp107', 'sorm']]
    """
    numbers = _checked_seeds(seeds)
    budget = checked_budget(max_evals)
    evaluator = Evaluator(max_seconds=max_seconds)
    file = or_none("path", path, checked_path)
    if file is not None and file.is_dir():
        file /= ROWS_NAME
    if not isinstance(workers, concurrent.futures.Executor):
        workers = whole("workers", workers, at_least=1)
    or_none("progress", progress, function)
    text("command", command, empty=True)
    built = labelled_methods(methods)
    asked = _named_problems(problems)
    questions = [
        _Question(problem, label, seed)
        for seed in numbers
        for problem in asked
        for label, method in built.items()
        if method.stochastic or seed == numbers[0]
    ]
    most = math.inf if budget is None else float(budget)
    codes = _codes(built, asked)
    longest = math.inf if evaluator.max_seconds is None else evaluator.max_seconds
    answers = {} if file is None else _kept(file, most, longest, built, asked, codes)
    answers = {question: answers[question] for question in questions if question in answers}
    tell = progress or (lambda done, total: None)
    tell(len(answers), len(questions))
    calls = {
        one: partial(_answered, one, asked[one.problem], built[one.label], budget, evaluator)
        for one in questions
        if one not in answers
    }
    for question, rows in _results(calls, workers):
        made = {
            "schema": SCHEMA,
            "max_evals": most,
            "code": codes[question.problem, question.label],
            "date": now(),
            "command": command,
        }
        answers[question] = [row | made for row in rows]
        if file is not None:
            append_rows(file, answers[question])
        tell(len(answers), len(questions))
    return benchmark_frame(row for question in questions for row in answers[question])


def _answered(
    question: _Question,
    problem: Problem,
    method: ReliabilityMethod,
    budget: int | None,
    evaluator: Evaluator,
) -> Rows:
    """Answer one question: a row for each criterion."""
    result = method.estimate(problem, max_evals=budget, rng=question.seed, evaluator=evaluator)
    rows = []
    for row, criterion in zip(result, result.criteria, strict=True):
        known = None if problem.references is None else problem.references.lookup(criterion)
        covered = None
        if known is not None and not math.isnan(row.ci_low + row.ci_high):
            slack = 2.0 * known.std_error
            covered = row.ci_low - slack <= known.pf <= row.ci_high + slack
        more = {"covered": covered, "inputs": problem.inputs.dimension, "settings": repr(method)}
        rows.append({**comparison_row(question.problem, question.label, row, known), **more})
    return rows


def _results(
    calls: Mapping[_Question, Callable[[], Rows]], workers: Workers
) -> Iterator[tuple[_Question, Rows]]:
    """Yield answers as they end."""
    if workers == 1 or not calls:
        yield from ((question, call()) for question, call in calls.items())
        return
    with _pool(workers) as pool:
        futures = {pool.submit(call): question for question, call in calls.items()}
        for future in concurrent.futures.as_completed(futures):
            yield futures[future], future.result()


@contextmanager
def _pool(workers: Workers) -> Iterator[concurrent.futures.Executor]:
    """Return an executor; processes of ours are ended with whatever they do when it is left."""
    if isinstance(workers, concurrent.futures.Executor):
        yield workers
        return
    ways = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in ways else "spawn")
    others = set(multiprocessing.active_children())
    pool = concurrent.futures.ProcessPoolExecutor(workers, context, initializer=follow_parent)
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()


def _kept(
    file: Path,
    budget: float,
    max_seconds: float,
    methods: Mapping[str, ReliabilityMethod],
    problems: Mapping[str, Problem],
    codes: Mapping[tuple[str, str], str],
) -> dict[_Question, Rows]:
    """Return the answers in a file that the same question would get again."""
    if not file.is_file():
        file.parent.mkdir(parents=True, exist_ok=True)
        return {}
    rows = read_benchmark(file)
    found: dict[_Question, dict[Criterion, dict[str, Any]]] = {}
    for row in rows[rows["max_evals"] == budget].to_dict("records"):
        question = _Question(row["problem"], row["label"], row["seed"])
        current = codes.get(question[:2]) == row["code"]
        ended_by = limit_told(row["message"])
        if ended_by is not None and float(f"{max_seconds:g}") > ended_by:
            continue  # there is more time now
        if current and repr(methods[question.label]) == row["settings"]:
            found.setdefault(question, {})[criterion_of(row)] = row
    grids = {name: checked_criteria(problem, None) for name, problem in problems.items()}
    return {
        question: [answers[criterion] for criterion in grids[question.problem]]
        for question, answers in found.items()
        if answers.keys() >= set(grids[question.problem])
    }


def _codes(
    methods: Mapping[str, ReliabilityMethod], problems: Mapping[str, Problem]
) -> dict[tuple[str, str], str]:
    """Return (problem, method) -> digest of what makes the rows: code, versions, problem."""
    of_methods = {label: source_of(method) for label, method in methods.items()}
    codes = {}
    for name, problem in problems.items():
        header = header_of(problem, {}, "", problem.references)
        known = [str(one) for one in problem.references or ()]
        of_problem = [known, *(header[part] for part in ("system", "source", "versions"))]
        for label, source in of_methods.items():
            document = json.dumps([*of_problem, source], sort_keys=True)
            codes[name, label] = hashlib.sha256(document.encode()).hexdigest()[:16]
    return codes


def _named_problems(problems: Problems) -> dict[str, Problem]:
    """Return name -> problem, each with known answers to its own criteria."""
    if isinstance(problems, str | Problem):
        problems = [problems]
    given = titles() if problems is None else listed("problems", problems, what="list of problems")
    named = dict(map(_named_problem, given))
    if not named or len(named) < len(given):
        raise refused("problems", list(named), "give one at least, and none of a name twice")
    for name, problem in named.items():
        known = problem.references
        if known is None or not any(map(known.lookup, checked_criteria(problem, None))):
            raise ValueError(f"problems: {name!r} has no known answer, build it with references=")
    return named


def _named_problem(problem: ProblemLike) -> tuple[str, Problem]:
    if isinstance(problem, str):
        if not problem.endswith(".toml") and ".py" not in problem:
            choice("problems", problem, available_problems())
        found = named_problem(problem)
        return found.name, found.problem()
    checked = instance("problems", problem, Problem, "give names or Problems")
    return checked.name, checked


def _checked_seeds(seeds: int | Iterable[int]) -> tuple[int, ...]:
    if not isinstance(seeds, Iterable) or isinstance(seeds, str | bytes):
        return tuple(range(whole("seeds", seeds, at_least=1)))
    numbers = tuple(whole("seeds", one, at_least=0) for one in listed("seeds", seeds))
    if not numbers or len(set(numbers)) < len(numbers):
        raise refused("seeds", numbers, "give different ones, one at least")
    return numbers
