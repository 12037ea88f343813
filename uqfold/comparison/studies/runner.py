"""Running a study: its comparisons and analyses, one table after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from uqfold.comparison.columns import rows_of
from uqfold.comparison.plan import plan_comparison
from uqfold.comparison.run import run_comparison
from uqfold.comparison.studies.builtin import (
    BUILT_IN,
    INPUTS,
    PROBLEMS,
    input_rows,
    problem_rows,
)
from uqfold.comparison.studies.cache import JobCache, job_key
from uqfold.comparison.studies.keys import listed
from uqfold.comparison.studies.registry import StepContext
from uqfold.comparison.studies.study import (
    METHOD_KEYS_OF_ANALYSES,
    RUN_COLUMNS,
    RunSpec,
    Spec,
    Study,
)
from uqfold.evaluation import Evaluator, Store
from uqfold.problems.base import Problem

STORE_NAME = "runs.db"
BATCH_ROWS = 1024
"""Model runs between two looks at Ctrl-C; has no influence on any number."""


@dataclass(frozen=True)
class Job:
    """One method on one problem with one budget and one seed, or one analysis.

    Attributes
    ----------
    title
        For the progress display, unique in the study.
    run
        The comparison it belongs to, or the analysis that it is.
    """

    title: str
    run: RunSpec | Spec
    problem: str = ""
    label: str = ""
    budget: int | None = None
    seed: int = 0


@dataclass(frozen=True)
class StudyTable:
    """A finished table.

    Attributes
    ----------
    name
        Name of the run or analysis.
    columns
        Column -> type.
    rows
        One mapping per row, with these columns.
    n_evals
        Model runs behind it, those from the store included.
    seconds
        Wall time (s) of making it; of what was taken from the cache, when it was made.
    reused
        Whether all of it was taken from the cache.
    """

    name: str
    columns: Mapping[str, type]
    rows: tuple[Mapping[str, Any], ...]
    n_evals: int
    seconds: float
    reused: bool


@dataclass(frozen=True)
class StudyRunner:
    """Makes the tables of a study.

    Attributes
    ----------
    study
        What to do.
    cache
        Folder of finished jobs and model runs, or None: nothing is kept.
    progress
        Called with (title of the job, model runs so far, runs expected or None), first with zero
        as a job starts. It may raise KeyboardInterrupt; what has finished is kept.
    """

    study: Study
    cache: Path | None = None
    progress: Callable[[str, int, int | None], None] | None = None

    @cached_property
    def problems(self) -> dict[str, Problem]:
        """The problems by name; the first access imports files that the study names.

        Raises
        ------
        StudyError
            If one cannot be built.
        """
        return {name: spec.build() for name, spec in self.study.problems.items()}

    def jobs(self) -> list[Job]:
        """Give everything there is to do, in order."""
        jobs = [job for run in self.study.runs for job in self._jobs_of(run)]
        return [*jobs, *(Job(one.name, one) for one in self.study.analyses)]

    def tables(self) -> Iterator[StudyTable]:
        """Run all jobs, and give each table as soon as it is complete, the built-in ones first."""
        for name, rows in (
            (PROBLEMS, problem_rows(self.problems)),
            (INPUTS, input_rows(self.problems)),
        ):
            yield StudyTable(name, BUILT_IN[name], tuple(rows), 0, 0.0, reused=True)
        if self.cache is not None:
            self.cache.mkdir(parents=True, exist_ok=True)
        jobs, cache = self.jobs(), JobCache(self.cache)
        asked: list[RunSpec | Spec] = [*self.study.runs, *self.study.analyses]
        for run in asked:
            columns = RUN_COLUMNS if isinstance(run, RunSpec) else run.kind.columns
            parts = [self._done(job, columns, cache) for job in jobs if job.run is run]
            yield StudyTable(
                name=run.name,
                columns=columns,
                rows=tuple(row for part in parts for row in part.rows),
                n_evals=sum(part.n_evals for part in parts),
                seconds=sum(part.seconds for part in parts),
                reused=all(part.reused for part in parts),
            )

    def _jobs_of(self, run: RunSpec) -> Iterator[Job]:
        for problem in run.problems:
            for label in run.methods:
                seeds = run.seeds if self.study.methods[label].stochastic else run.seeds[:1]
                for budget in run.budgets:
                    for seed in seeds:
                        words = [run.name, problem, label]
                        words += [] if len(run.budgets) == 1 else [f"{budget:,}"]
                        words += [] if len(seeds) == 1 else [f"seed {seed}"]
                        yield Job(" / ".join(words), run, problem, label, budget, seed)

    def _done(self, job: Job, columns: Mapping[str, type], cache: JobCache) -> StudyTable:
        """Give the rows of a job from the cache, or else do it."""
        kept_columns = {**columns, "_n_evals": int, "_seconds": float}
        key = self._key(job)
        kept = None if key is None else cache.get(key, kept_columns)
        reused = kept is not None
        if kept is None:
            if self.progress is not None:
                self.progress(job.title, 0, None)
            started = time.perf_counter()
            rows, n_evals = self._rows(job)
            seconds = time.perf_counter() - started
            if self.progress is not None:
                # an interruption may have been swallowed by a library: nothing half is kept
                self.progress(job.title, n_evals, n_evals)
            kept = [{**row, "_n_evals": n_evals, "_seconds": seconds} for row in rows]
            # what failed may succeed another time
            if key is not None and all(row.get("status") != "failed" for row in rows):
                cache.put(key, kept_columns, kept)
        return StudyTable(
            name=job.run.name,
            columns=columns,
            rows=tuple({name: row[name] for name in columns} for row in kept),
            n_evals=int(kept[0]["_n_evals"]) if kept else 0,
            seconds=float(kept[0]["_seconds"]) if kept else 0.0,
            reused=reused,
        )

    def _rows(self, job: Job) -> tuple[list[dict[str, Any]], int]:
        if isinstance(job.run, Spec):
            return self._analysed(job, job.run)
        plan = plan_comparison(
            self.problems[job.problem],
            {job.label: self.study.methods[job.label]},
            job.run.criteria,
            max_evals=job.budget,
            rng=job.seed,
            evaluator=self._evaluator(job.problem),
        )

        def progress(_: str, n_evals: int, expected: int | None) -> None:
            if self.progress is not None and n_evals:
                self.progress(job.title, n_evals, expected)

        [frame] = run_comparison(plan, progress)
        budget = float("nan") if job.budget is None else float(job.budget)
        rows = [{**row, "problem": job.problem, "max_evals": budget} for row in rows_of(frame)]
        return rows, int(rows[0]["n_evals"])

    def _analysed(self, job: Job, spec: Spec) -> tuple[list[dict[str, Any]], int]:
        spent = {"n": 0}

        def evaluator(problem: str) -> Evaluator:
            before = spent["n"]

            def progress(n_evals: int, expected: int | None) -> None:
                spent["n"] = before + n_evals
                if self.progress is not None:
                    total = None if expected is None else before + expected
                    self.progress(job.title, spent["n"], total)

            return replace(self._evaluator(problem), progress=progress)

        context = StepContext(self.problems, self.study.methods, evaluator)
        frame = spec.kind.call(spec.settings, context)
        if list(frame.columns) != list(spec.kind.columns):
            raise TypeError(
                f"analysis {spec.kind.name!r} gave the columns {list(frame.columns)}, not "
                f"{list(spec.kind.columns)}"
            )
        rows = [
            {
                name: kind(value)
                for (name, kind), value in zip(spec.kind.columns.items(), row, strict=True)
            }
            for row in frame.itertuples(index=False, name=None)
        ]
        return rows, spent["n"]

    @cached_property
    def _store(self) -> Store | None:
        return None if self.cache is None else Store(self.cache / STORE_NAME)

    def _evaluator(self, problem: str) -> Evaluator:
        kept = self.study.problems[problem].settings["store"]
        versioned = self.problems[problem].version is not None
        store = self._store if kept and versioned else None
        return Evaluator(batch_rows=BATCH_ROWS, store=store)

    def _key(self, job: Job) -> str | None:
        """Give the key of a job, or None if its answer may change without a trace."""
        if isinstance(job.run, Spec):
            named = [
                name
                for key in ("problem", "problems")
                for name in listed(job.run.settings.get(key))
            ]
            labels = [
                label
                for key in METHOD_KEYS_OF_ANALYSES
                for label in listed(job.run.settings.get(key))
            ]
            what = [job.run.kind.name, repr(sorted(job.run.settings.items()))]
        else:
            named, labels = [job.problem], [job.label]
            what = [repr(job.run.criteria), str(job.budget), str(job.seed)]
        if any(self.problems[name].version is None for name in named):
            return None
        described = [self._described(name) for name in named]
        return job_key([*what, *described, *(repr(self.study.methods[one]) for one in labels)])

    def _described(self, name: str) -> str:
        spec, problem = self.study.problems[name], self.problems[name]
        inputs = problem.inputs
        parts = [
            name,
            spec.settings["case"],
            spec.settings["function"],
            spec.settings["options"],
            spec.fingerprint(),
            problem.version,
            problem.n_units,
            inputs.names,
            inputs.n_shared,
            repr(inputs.distribution),
        ]
        return repr(parts)
