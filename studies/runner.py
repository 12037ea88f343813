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
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import pandas as pd

import uqfold
from uqfold import plots, provenance
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
DIGITS = 10
"""Significant digits of numbers in tables."""

TEXTS = (
    "problem", "label", "missions", "message", "unit", "response_unit", "reference_how",
    "reference_command", "verified_by", "value_meets", "safe_meets", "agrees",
)  # fmt: skip
"""Columns of texts that may all be empty, or look like numbers."""
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
}  # fmt: skip
"""Estimates and the columns of their errors."""
OWNERS = ("derivative", "index", "difference", "value", "pf")
"""The first of these that a table has is the estimate that ``std_error`` belongs to."""
SURE = ("reference_pf", "reference_std_error", "pf", "pf_independent", "difference")
"""Columns that depend on no sample; of a table with ``std_error`` only those of references."""
MAGNIFIED = ("error", "efficiency", "seconds")
"""Columns that nobody compares: they magnify rounding, or are never the same."""
STANDARD_ERRORS = 5.0
"""Joint standard errors by which estimates from two samples may differ."""
ADAPTIVE = ("active-kriging",)
"""Methods that choose their own runs: their rows always count as another sample."""
OPTIONS = {
    "quick": "run the reduced form, into .quick beside the studies",
    "redraw": "run nothing: write figures and report anew from the tables that are there",
    "check": "compare the reduced form with the tables that are there, and write nothing",
}

Tables = Callable[["Run"], None]


class Run:
    """One run of a study: its name, whether it is the reduced form, and its tables.

    Parameters
    ----------
    name
        Name of the study.
    quick
        Whether it is the reduced form.
    out
        Folder to write to, or None.
    store
        File in which values of models are kept, or None.
    """

    def __init__(
        self, name: str, quick: bool = False, out: Path | None = None, store: Path | None = None
    ) -> None:
        self.name, self.quick, self.out = name, quick, out
        self.tables: dict[str, pd.DataFrame] = {}
        self.record: dict[str, Any] = {}
        self._began = time.perf_counter()
        self._store = None
        if store is not None:
            store.parent.mkdir(parents=True, exist_ok=True)
            self._store = uqfold.evaluation.Store(store)

    def choose(self, full: Any, quick: Any) -> Any:
        """Return the second in the reduced form, else the first."""
        return quick if self.quick else full

    def evaluator(self, problem: uqfold.Problem) -> uqfold.Evaluator:
        """Return how the model of a problem is evaluated."""
        store = None if problem.name in FORMULAS else self._store
        return uqfold.Evaluator(batch_rows=1024, store=store)

    def problems(self, problems: Mapping[str, uqfold.Problem]) -> None:
        """Keep the tables ``problems`` and ``inputs``."""
        rows, inputs = [], []
        for name, problem in problems.items():
            known, own = problem.references, problem.inputs
            how, command = (known.how, known.command) if known else ("", "")
            rows.append((name, problem.response, problem.response_unit, problem.n_units, how,
                         command))  # fmt: skip
            individual = len(own.names) - own.n_shared
            inputs.append(pd.DataFrame({
                "problem": name, "input": own.names, "unit": problem.input_units,
                "role": ["shared"] * own.n_shared + ["individual"] * individual,
                "distribution": own.families, "mean": own.means, "std": own.standard_deviations,
            }))  # fmt: skip
        columns = ["problem", "response", "response_unit", "units"]
        columns += ["reference_how", "reference_command"]
        self.keep("problems", pd.DataFrame(rows, columns=columns))
        self.keep("inputs", pd.concat(inputs, ignore_index=True))

    def answers(
        self,
        problems: Mapping[str, uqfold.Problem],
        methods: Mapping[str, uqfold.ReliabilityMethod],
        criteria: uqfold.Criteria,
        budgets: Sequence[int | None] = (None,),
        seeds: int = 1,
    ) -> pd.DataFrame:
        """Return the answers of every method on every problem, with every budget and seed.

        A method without randomness runs with the first seed only.
        """
        frames = []
        for name, label, budget in product(problems, methods, budgets):
            problem, method = problems[name], methods[label]
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
            results = self.out / "results"
            results.mkdir(parents=True, exist_ok=True)
            written = self.tables[name].to_csv(index=False, float_format=f"%.{DIGITS}g")
            write_text(results / f"{name}.csv", written)
            print(f"{name}: {len(frame)} rows", file=sys.stderr)

    def rows(self, *names: str, **where: Any) -> pd.DataFrame:
        """Return rows of tables with these values (or one of a list); None is a missing number."""
        frame = pd.concat([self.tables[name] for name in names], ignore_index=True)
        for column, wanted in where.items():
            values = wanted if isinstance(wanted, list) else [wanted]
            own = frame[column].astype(object)
            frame = frame[own.where(own.notna(), None).isin(values)]
        frame = frame.reset_index(drop=True)
        if "problems" in self.tables:
            header = self.tables["problems"].iloc[0]
            frame.attrs["uqfold-comparison"] = dict(header[["response", "response_unit"]])
        return frame

    def write_record(self) -> None:
        """Write beside the tables what made them."""
        command = f"python studies/{self.name}/study.py{' --quick' if self.quick else ''}"
        made = provenance.made_by(*NUMBERS_BY, command=command)
        seconds = round(time.perf_counter() - self._began)
        self.record = {
            "schema": SCHEMA, "quick": self.quick, **made, "seconds": seconds,
            "tables": [*self.tables],
        }  # fmt: skip
        if self.out is not None:
            text = json.dumps(self.record, indent=1, ensure_ascii=False) + "\n"
            write_text(self.out / "results" / "record.json", text)


def main(
    study: str, tables: Tables, page: Callable[[Run], Page], tolerance: tuple[float, float]
) -> None:
    """Run a study as its command line asks.

    Parameters
    ----------
    study
        ``__file__`` of the script.
    tables, page
        What makes its tables, and what shows them.
    tolerance
        Relative and absolute difference up to which `--check` takes two numbers for the same.
    """
    folder = Path(study).resolve().parent
    parser = argparse.ArgumentParser(description=f"Run the study {folder.name}.")
    asked = parser.add_mutually_exclusive_group()
    for name, words in OPTIONS.items():
        asked.add_argument(f"--{name}", action="store_true", help=words)
    options = parser.parse_args()
    if options.check:
        found = differences(_kept(folder), tables, tolerance, STORE)
        print(f"{folder.name}: {f'{len(found)} differences' if found else 'holds'}")
        print(*(f"  {one}" for one in found[:10]), sep="\n")
        sys.exit(1 if found else 0)
    out = folder.parent / ".quick" / folder.name if options.quick else folder
    if options.redraw:
        run = _kept(folder)
        run.out = out
    else:
        run = Run(folder.name, options.quick, out, STORE)
        tables(run)
        run.write_record()
    with plots.figure_settings():
        page(run).write(out / "report.md")
    print(f"{folder.name}: {len(run.tables)} tables and report.md in {out}")


def _kept(folder: Path) -> Run:
    """Return what `read_run` reads, or end with one line that says why it cannot."""
    try:
        return read_run(folder)
    except FileNotFoundError as error:
        missing = Path(error.filename).relative_to(folder)
        why = f"there is no {missing}: run it in full first, python studies/{folder.name}/study.py"
    except ValueError as error:
        why = str(error)
    print(f"{folder.name}: {why}", file=sys.stderr)
    sys.exit(2)


def read_run(folder: Path) -> Run:
    """Read the tables and the record of a study that has been run.

    Raises
    ------
    ValueError
        If they are of another schema.
    FileNotFoundError
        If the study has not been run in full.
    """
    run, results = Run(folder.name), folder / "results"
    run.record = json.loads((results / "record.json").read_text(encoding="utf-8"))
    schema = run.record.get("schema", SCHEMA)
    if schema != SCHEMA:
        raise ValueError(
            f"{results}: the tables are of schema {schema!r}, not {SCHEMA!r}: run the study again"
        )
    run.quick = run.record["quick"]
    for name in run.record["tables"]:
        frame = pd.read_csv(
            results / f"{name}.csv", dtype=dict.fromkeys(TEXTS, str), na_values=[""],
            keep_default_na=False,
        )  # fmt: skip
        run.tables[name] = frame.fillna({column: "" for column in TEXTS if column in frame})
    return run


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
    problems = run.tables.get("problems", pd.DataFrame({"reference_how": []}))
    for how, rows in problems.query("reference_how != ''").groupby("reference_how", sort=False):
        page.section("References")
        names = ", ".join(f"`{name}`" for name in rows["problem"])
        page.text(f"{names}: {how} Made by `{rows['reference_command'].iloc[0]}`.")
    said = [frame for frame in run.tables.values() if {"method", "message"} <= {*frame}]
    if said:
        page.section("What the methods say of their own answers")
        rows = pd.concat(said, ignore_index=True).query("status != 'converged'")
        rows = rows.replace({"message": {"": "nobody estimated the error of the answer"}})
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


def differences(
    committed: Run, tables: Tables, tolerance: tuple[float, float], store: Path | None = None
) -> list[str]:
    """Compare the reduced form of a study with its committed tables; return what differs."""
    fresh = Run(committed.name, quick=True, store=store)
    tables(fresh)
    found = [f"{name}: not made" for name in committed.tables if name not in fresh.tables]
    for name, frame in fresh.tables.items():
        if name not in committed.tables:
            found.append(f"{name}: not among the committed tables")
            continue
        found += [f"{name}: {one}" for one in compared(committed.tables[name], frame, tolerance)]
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
    known = {}
    for row in committed.to_dict("records"):
        known[_values(row, keys)] = known[_values(row, exact)] = row
    numbers = fresh.select_dtypes("float").columns.difference([*exact, *sample, *MAGNIFIED])
    errors = {name: error for name, error in ERROR_OF.items() if name in fresh}
    sure = [name for name in SURE if name in fresh]
    if "std_error" in fresh:
        errors[next(name for name in OWNERS if name in fresh)] = "std_error"
        sure = [name for name in sure if name.startswith("reference")]
    for row in fresh.to_dict("records"):
        where = ", ".join(f"{name} = {row[name]}" for name in exact)
        partner = known.get(_values(row, exact)) or known.get(_values(row, keys))
        if partner is None:
            yield f"{where}: not among the committed rows"
            continue
        same = _values(row, sample) == _values(partner, sample) and row.get("label") not in ADAPTIVE
        for name in numbers if same else sure:
            one, other = row[name], partner[name]
            close = math.isclose(one, other, rel_tol=tolerance[0], abs_tol=tolerance[1])
            if not close and not (math.isnan(one) and math.isnan(other)):
                yield f"{where}: {name} = {one!r}, committed {other!r}"
        for name, error in ({} if same else errors).items():
            joint = math.hypot(row[error], partner[error])
            if abs(row[name] - partner[name]) > STANDARD_ERRORS * joint:
                yield f"{where}: {name} = {row[name]!r}, committed {partner[name]!r} ± {joint:.2g}"


def _values(row: Mapping[Any, Any], names: Collection[str]) -> tuple[Any, ...]:
    """Return some values of a row, with None for NaN, which equals nothing."""
    return tuple(None if row[name] != row[name] else row[name] for name in names)
