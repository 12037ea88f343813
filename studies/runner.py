"""The runner of a study.

A study is a script with two functions: `tables(run)` answers its question and keeps every table,
`page(run)` shows them. `main` gives it its options, see `OPTIONS`.

Values of models are kept in `studies/.cache/evaluations.db`: a second run takes seconds where the
model is what takes long, and an interrupted one goes on where it stopped.
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import uqfold
from uqfold import plots, provenance
from uqfold.comparison.columns import ATTRIBUTE
from uqfold.report import Page
from uqfold.writing import write_text

SCHEMA = "uqfold-study-results/2"
"""What the record of a study says of the form of its tables; none said is the present one."""
STORE = Path(__file__).resolve().parent / ".cache" / "evaluations.db"
FORMULAS = ("series", "four-bar")
"""Problems whose model is faster than the disk: nothing of them is kept."""
NUMBERS_BY = ("uqfold.comparison.run", "uqfold.analysis")
"""What makes the numbers of a study; all that it imports counts too."""
LEFT_OUT = [
    "beta", "ci_kind", "pf_low", "pf_high", "error_kind", "n_evals_row", "n_reused", "n_failed",
    "seconds",
]  # fmt: skip
"""Columns of comparisons that no study shows."""
OPTIONS = {
    "quick": "run the reduced form, into .quick beside the studies",
    "redraw": "run nothing: write figures and report anew from the tables that are there",
    "check": "compare the reduced form with the tables that are there, and write nothing",
}

KEYS = (
    "problem", "label", "other", "parameter", "input", "moment", "order", "units", "relative",
    "synchronized", "decade", "threshold", "tau", "missions", "target_pf", "step",
    "theta_1_initial", "x_lock",
)  # fmt: skip
"""Columns that tell the rows of a table apart, besides budget and seed."""
SAMPLE = ("seed", "n_evals", "runs", "sampled_responses", "draws", "repeats", "verified_n_evals")
"""Columns whose values say together whether two rows come from the same sample."""
ERROR_OF = {
    "per_std": "per_std_error", "elasticity": "elasticity_error", "pf_mean": "pf_std",
    "sampled_difference": "sampled_std_error", "bias": "rms",
    **dict.fromkeys(("derivative", "index", "difference", "value", "pf"), "std_error"),
}  # fmt: skip
"""Estimates and the columns of their errors."""
SURE = ("reference_pf", "reference_std_error", "pf", "pf_independent", "difference")
"""Columns that depend on no sample, where they have no error."""
NOT_COMPARED = ("max_evals", "error", "efficiency", "seconds")
"""Columns that are asked for, magnify rounding, or are never the same."""
STANDARD_ERRORS = 5.0
"""Joint standard errors by which estimates from two samples may differ."""
ADAPTIVE = ("active-kriging",)
"""Methods that choose their own runs: their rows always count as another sample."""

Problems = Mapping[str, uqfold.Problem]


@dataclass
class Run:
    """One run of a study: its name and problems, whether it is the reduced form, and its tables.

    Without `out` nothing is written, and without `store` no values of models are kept.
    """

    name: str
    problems: Problems
    quick: bool = False
    out: Path | None = None
    store: uqfold.evaluation.Store | None = None
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)
    record: dict[str, Any] = field(default_factory=dict)

    def choose(self, full: Any, quick: Any) -> Any:
        """Return the second in the reduced form, else the first."""
        return quick if self.quick else full

    def evaluator(self, problem: uqfold.Problem) -> uqfold.Evaluator:
        """Return how the model of a problem is evaluated."""
        store = None if problem.name in FORMULAS else self.store
        return uqfold.Evaluator(batch_rows=1024, store=store)

    def answers(
        self,
        problems: Problems,
        methods: Mapping[str, uqfold.ReliabilityMethod],
        criteria: uqfold.Criteria,
        budgets: Sequence[int | None] = (None,),
        seeds: int = 1,
    ) -> pd.DataFrame:
        """Return the answers of every method on every problem, with every budget and seed.

        A method without randomness runs with the first seed only.
        """
        frames = []
        for (name, problem), (label, method), budget in product(
            problems.items(), methods.items(), budgets
        ):
            for seed in range(seeds if method.stochastic else 1):
                frame = uqfold.compare(
                    problem, {label: method}, criteria, max_evals=budget, rng=seed,
                    evaluator=self.evaluator(problem),
                ).drop(columns=LEFT_OUT)  # fmt: skip
                frame["problem"] = name
                frame.insert(2, "max_evals", math.nan if budget is None else float(budget))
                frame.attrs = {}
                frames.append(frame)
        return pd.concat(frames, ignore_index=True)

    def compare(self, name: str, *asked: Any) -> None:
        """Keep what `answers` returns as a table."""
        self.keep(name, self.answers(*asked))

    def keep(self, name: str, frame: pd.DataFrame, **first: Any) -> None:
        """Keep a table, and write it at once; `first` are columns to put before its own."""
        own = [column for column in frame.columns if column not in first]
        self.tables[name] = frame.assign(**first)[[*first, *own]]
        if self.out is not None:
            written = self.tables[name].to_csv(index=False, float_format="%.10g")
            self._write(f"{name}.csv", written)
            print(f"{name}: {len(frame)} rows", file=sys.stderr)

    def rows(self, *names: str, **where: Any) -> pd.DataFrame:
        """Return rows of tables with these values (or one of a list); None is a missing number."""
        frame = pd.concat([self.tables[name] for name in names], ignore_index=True)
        frame = frame.fillna(dict.fromkeys(frame.select_dtypes(exclude="number"), ""))
        for column, wanted in where.items():
            values = wanted if isinstance(wanted, list) else [wanted]
            own = frame[column].astype(object)
            frame = frame[own.where(own.notna(), None).isin(values)]
        frame = frame.reset_index(drop=True)
        for problem in [*self.problems.values()][:1]:
            header = {"response": problem.response, "response_unit": problem.response_unit}
            frame.attrs[ATTRIBUTE] = header
        return frame

    def finish(self, seconds: float) -> None:
        """Write beside the tables what made them."""
        command = f"python studies/{self.name}/study.py{' --quick' if self.quick else ''}"
        self.record = {
            "schema": SCHEMA, "quick": self.quick,
            **provenance.made_by(*NUMBERS_BY, command=command), "seconds": round(seconds),
            "tables": [*self.tables],
        }  # fmt: skip
        self._write("record.json", json.dumps(self.record, indent=1, ensure_ascii=False) + "\n")

    def _write(self, file: str, written: str) -> None:
        if self.out is not None:
            results = self.out / "results"
            results.mkdir(parents=True, exist_ok=True)
            write_text(results / file, written)


Tables = Callable[[Run], None]


def main(
    study: str,
    problems: Problems,
    tables: Tables,
    page: Callable[[Run], Page],
    tolerance: tuple[float, float],
) -> None:
    """Run a study as its command line asks.

    Parameters
    ----------
    study
        ``__file__`` of the script.
    problems, tables, page
        What it asks about, what makes its tables, and what shows them.
    tolerance
        Relative and absolute difference up to which `--check` takes two numbers for the same.
    """
    folder = Path(study).resolve().parent
    parser = argparse.ArgumentParser(description=f"Run the study {folder.name}.")
    asked = parser.add_mutually_exclusive_group()
    for name, words in OPTIONS.items():
        asked.add_argument(f"--{name}", action="store_true", help=words)
    options = parser.parse_args()
    STORE.parent.mkdir(parents=True, exist_ok=True)
    store = uqfold.evaluation.Store(STORE)
    if options.redraw or options.check:
        try:
            run = read_run(folder, problems)
        except (OSError, ValueError) as error:
            parser.exit(2, f"{folder.name}: {error}\n")
        if options.check:
            found = differences(run, tables, tolerance, store)
            print(f"{folder.name}: {f'{len(found)} differences' if found else 'holds'}")
            print(*(f"  {one}" for one in found[:10]), sep="\n")
            sys.exit(1 if found else 0)
    else:
        out = folder.parent / ".quick" / folder.name if options.quick else folder
        run = Run(folder.name, problems, options.quick, out, store)
        began = time.perf_counter()
        tables(run)
        run.finish(time.perf_counter() - began)
    out = run.out or folder
    with plots.figure_settings():
        page(run).write(out / "report.md")
    print(f"{folder.name}: {len(run.tables)} tables and report.md in {out}")


def read_run(folder: Path, problems: Problems) -> Run:
    """Read the tables and the record of a study that has been run.

    Raises
    ------
    ValueError
        If the study has not been run in full, or the tables are of another schema.
    """
    results = folder / "results"
    if not (results / "record.json").is_file():
        script = f"python studies/{folder.name}/study.py"
        raise ValueError(f"there is no results/record.json: run it in full first, {script}")
    record = json.loads((results / "record.json").read_text(encoding="utf-8"))
    schema = record.get("schema", SCHEMA)
    if schema != SCHEMA:
        raise ValueError(
            f"{results}: the tables are of schema {schema!r}, not {SCHEMA!r}: run the study again"
        )
    # an empty cell is a missing number; `Run.rows` makes an empty text of it among texts
    how: Any = {"dtype": {"missions": str}, "keep_default_na": False, "na_values": [""]}
    tables = {name: pd.read_csv(results / f"{name}.csv", **how) for name in record["tables"]}
    return Run(folder.name, problems, record["quick"], folder, None, tables, record)


def new_page(run: Run, text: str) -> Page:
    """Return the page of a study: the lines of `text` are its title, its question, and notes."""
    title, question, *notes = text.strip().split("\n\n")
    page = Page(title.rstrip("."), question, kind="Study")
    if run.quick:
        page.text("*Reduced form: fewer points than the study asks for.*")
    page.text("\n\n".join(notes))
    return page


def finish(page: Page, run: Run, methods: Mapping[str, uqfold.ReliabilityMethod]) -> Page:
    """Add what every page ends with: references, what methods say, and what made the tables."""
    known = {name: one.references for name, one in run.problems.items() if one.references}
    for how, command in dict.fromkeys((one.how, one.command) for one in known.values()):
        page.section("References")
        names = ", ".join(f"`{name}`" for name, one in known.items() if one.how == how)
        page.text(f"{names}: {how} Made by `{command}`.")
    said = [frame for frame in run.tables.values() if {"method", "message"} <= {*frame}]
    if any((frame["status"] != "converged").any() for frame in said):
        page.section("What the methods say of their own answers")
        rows = pd.concat(said, ignore_index=True).query("status != 'converged'")
        message = rows["message"].astype(object).fillna("")
        rows["message"] = message.where(message != "", "nobody estimated the error of the answer")
        counts = rows.value_counts(["label", "status", "message"]).reset_index(name="rows")
        more = f"{len(counts)} different messages in all." if len(counts) > 12 else ""
        page.table(counts.head(12), "Answers that are not converged", more)
    page.section("How it was made")
    made = run.record
    versions = ", ".join(f"{name} {one}" for name, one in made["versions"].items())
    page.text(f"`{made['command']}`, {made['date']}, in {made['seconds']} s; {versions}")
    sizes = ", ".join(f"`{name}` ({len(frame)} rows)" for name, frame in run.tables.items())
    page.text(f"Tables in results/: {sizes}.")
    page.text("\n".join(f"- `{label}`: `{method!r}`" for label, method in methods.items()))
    return page


def percent(value: float, sign: str = "") -> str:
    """Write a share or a relative error in per cent, with two digits; a `sign` of "+" for both."""
    if math.isnan(value):
        return ""
    digits = ",.0f" if abs(value) >= 0.995 else ".2g"
    return f"{100.0 * value:{sign}{digits}} %"


def differences(
    committed: Run,
    tables: Tables,
    tolerance: tuple[float, float],
    store: uqfold.evaluation.Store | None = None,
) -> list[str]:
    """Compare the reduced form of a study with its committed tables; return what differs."""
    fresh = Run(committed.name, committed.problems, quick=True, store=store)
    tables(fresh)
    names = committed.tables.keys() ^ fresh.tables.keys()
    found = [f"{name}: not among both committed and fresh tables" for name in sorted(names)]
    for name in fresh.tables.keys() - names:
        own, frame = committed.tables[name], fresh.tables[name]
        found += [f"{name}: {one}" for one in compared(own, frame, tolerance)]
    return found


def compared(
    committed: pd.DataFrame, fresh: pd.DataFrame, tolerance: tuple[float, float]
) -> Iterator[str]:
    """Hold fresh rows against committed ones, and say what differs.

    A fresh row is compared with the committed row of the same keys, budget and seed, or else of
    the same keys. Numbers from the same sample have to agree to the tolerance, estimates from
    another one in their joint standard errors: methods that choose their own evaluations take
    another sample wherever sums round differently.
    """
    keys, sample = ([name for name in names if name in fresh] for names in (KEYS, SAMPLE))
    exact = [*keys, *(name for name in ("max_evals", "seed") if name in fresh)]
    numbers = fresh.select_dtypes("float").columns.difference([*exact, *sample, *NOT_COMPARED])
    errors = {name: error for name, error in ERROR_OF.items() if {name, error} <= {*fresh}}
    known = {}
    for row in committed.to_dict("records"):
        known[_values(row, keys)] = known[_values(row, exact)] = row
    for row in fresh.to_dict("records"):
        where = ", ".join(f"{name} = {row[name]}" for name in exact)
        partner = known.get(_values(row, exact)) or known.get(_values(row, keys))
        if partner is None:
            yield f"{where}: not among the committed rows"
            continue
        same = _values(row, sample) == _values(partner, sample) and row.get("label") not in ADAPTIVE
        for name in numbers:
            one, other = row[name], partner[name]
            allowed = tolerance[0] * abs(other) + tolerance[1]
            if not same and name in errors:
                # an estimate without an error says nothing that could be wrong
                allowed = STANDARD_ERRORS * math.hypot(row[errors[name]], partner[errors[name]])
                differs = abs(one - other) > allowed
            elif same or name in SURE:
                differs = not np.isclose(one, other, *tolerance, equal_nan=True)
            else:
                continue
            if differs:
                yield f"{where}: {name} = {one!r}, committed {other!r} ± {allowed:.2g}"


def _values(row: Mapping[Any, Any], names: Sequence[str]) -> tuple[Any, ...]:
    """Return some values of a row, with None for NaN, which equals nothing."""
    return tuple(None if row[name] != row[name] else row[name] for name in names)
