"""The runner of a study.

A study is a script with two functions: `tables(run)` answers its question and keeps every table,
`page(run)` shows them. `main` gives it these options:

    --quick      the reduced form, into studies/.quick/<name> unless --out says where
    --redraw     run nothing: write figures and report anew from the tables that are there
    --check      compare the reduced form with the tables that are there, and write nothing
    --out DIR    where to write instead of the study's own folder

Values of models are kept in `studies/.cache/evaluations.db`: a second run takes seconds where the
model is what takes long, and an interrupted one goes on where it stopped.
"""

import argparse
import csv
import json
import math
import sys
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

import uqfold
from uqfold import plots, provenance
from uqfold.report import Page

ROOT = Path(__file__).resolve().parent
STORE = ROOT / ".cache" / "evaluations.db"
FORMULAS = ("series", "four-bar")
"""Problems whose model is faster than the disk: nothing of them is kept."""
NUMBERS_BY = ("uqfold.comparison.run", "uqfold.analysis")
"""What makes the numbers of a study; all that it imports counts too."""

Tables = Callable[["Run"], None]


class Run:
    """One run of a study: its tables, and how models are evaluated.

    Parameters
    ----------
    name
        Name of the study.
    quick
        Whether it is the reduced form.
    out
        Folder to write to, or None.
    store
        File of the store, or None: nothing is kept.

    Attributes
    ----------
    tables
        Name -> table of what has been kept so far.
    """

    def __init__(
        self, name: str, quick: bool = False, out: Path | None = None, store: Path | None = None
    ) -> None:
        self.name, self.quick, self.out = name, quick, out
        self.tables: dict[str, pd.DataFrame] = {}
        self.record: dict[str, Any] = {"date": "", "versions": {}, "tables": []}
        self._store = None
        if store is not None:
            store.parent.mkdir(parents=True, exist_ok=True)
            self._store = uqfold.evaluation.Store(store)
        self._began = time.perf_counter()

    def choose(self, full: Any, quick: Any) -> Any:
        """Return the second in the reduced form, else the first."""
        return quick if self.quick else full

    def evaluator(self, problem: uqfold.Problem, keep: bool = True) -> uqfold.Evaluator:
        """Return how the model of a problem is evaluated; `keep`: whether its values are kept."""
        kept = keep and problem.name not in FORMULAS
        return uqfold.Evaluator(batch_rows=1024, store=self._store if kept else None)

    def problems(self, problems: Mapping[str, uqfold.Problem]) -> None:
        """Keep the tables ``problems`` and ``inputs``."""
        rows, inputs = [], []
        for name, problem in problems.items():
            known = problem.references
            source = ("", "", "") if known is None else (known.kind, known.how, known.command)
            rows.append((name, problem.response, problem.response_unit, problem.n_units, *source))
            for i, family in enumerate(problem.inputs.families):
                role = "shared" if i < problem.inputs.n_shared else "individual"
                named = problem.inputs.names[i], problem.input_units[i]
                moments = problem.inputs.means[i], problem.inputs.standard_deviations[i]
                inputs.append((name, *named, role, family, *moments))
        columns = ["problem", "response", "response_unit", "units"]
        columns += ["reference_kind", "reference_how", "reference_command"]
        self.keep("problems", pd.DataFrame(rows, columns=columns))
        columns = ["problem", "input", "unit", "role", "distribution", "mean", "std"]
        self.keep("inputs", pd.DataFrame(inputs, columns=columns))

    def compare(
        self,
        name: str,
        problems: Mapping[str, uqfold.Problem],
        methods: Mapping[str, uqfold.ReliabilityMethod],
        criteria: uqfold.Criteria,
        budgets: Sequence[int | None] = (None,),
        seeds: int = 1,
    ) -> None:
        """Keep the answers of every method on every problem, with every budget and seed.

        A method without randomness runs with the first seed only.
        """
        frames = []
        for key, problem in problems.items():
            for label, method in methods.items():
                for budget in budgets:
                    for seed in range(seeds if method.stochastic else 1):
                        self._say(f"{name}: {key}, {label}, budget {budget}, seed {seed}")
                        frame = uqfold.compare(
                            problem, {label: method}, criteria, max_evals=budget, rng=seed,
                            evaluator=self.evaluator(problem),
                        ).drop(columns=["seconds", "n_reused"])  # fmt: skip
                        frame["problem"] = key
                        frame.insert(2, "max_evals", math.nan if budget is None else float(budget))
                        frame.attrs = {}
                        frames.append(frame)
        self.keep(name, pd.concat(frames, ignore_index=True))

    def keep(self, name: str, frame: pd.DataFrame, **first: Any) -> None:
        """Keep a table, and write it at once; `first` are columns to put before its own."""
        own = [column for column in frame.columns if column not in first]
        frame = frame.assign(**first)[[*first, *own]]
        self.tables[name] = frame
        now = time.perf_counter()
        seconds = round(now - self._began, 3)
        entry = {"name": name, "rows": len(frame), "seconds": seconds, "date": provenance.now()}
        self.record["tables"].append(entry)
        self._began = now
        if self.out is not None:
            text = frame.to_csv(index=False, lineterminator="\n")
            _write(self.out / "results" / f"{name}.csv", text)
        self._say("")

    def rows(self, *names: str, **where: Any) -> pd.DataFrame:
        """Return rows of tables with these values (or one of a list); None is a missing number."""
        frame = pd.concat([self.tables[name] for name in names], ignore_index=True)
        for column, wanted in where.items():
            values = wanted if isinstance(wanted, list) else [wanted]
            chosen = frame[column].isin([value for value in values if value is not None])
            frame = frame[chosen | frame[column].isna()] if None in values else frame[chosen]
        frame = frame.reset_index(drop=True)
        if len(self.tables["problems"]):
            problem = self.tables["problems"].iloc[0]
            header = {name: problem[name] for name in ("response", "response_unit")}
            frame.attrs["uqfold-comparison"] = header
        return frame

    def write_record(self) -> None:
        """Write beside the tables what made them."""
        command = f"python studies/{self.name}/study.py{' --quick' if self.quick else ''}"
        made = provenance.made_by(*NUMBERS_BY, command=command)
        self.record = {"quick": self.quick, **made, "tables": self.record["tables"]}
        if self.out is not None:
            text = json.dumps(self.record, indent=1, ensure_ascii=False) + "\n"
            _write(self.out / "results" / "record.json", text)

    def _say(self, text: str) -> None:
        if self.out is not None and sys.stderr.isatty():
            print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def main(
    study: str,
    tables: Tables,
    page: Callable[[Run], Page],
    tolerance: tuple[float, float],
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
    for name, words in (
        ("quick", "run the reduced form"),
        ("redraw", "run nothing, draw anew from the tables"),
        ("check", "compare the reduced form with the tables"),
    ):
        parser.add_argument(f"--{name}", action="store_true", help=words)
    parser.add_argument("--out", type=Path, metavar="DIR", help="where to write")
    asked = parser.parse_args()
    out = asked.out or (ROOT / ".quick" / folder.name if asked.quick else folder)
    try:
        if asked.check:
            found = differences(folder, tables, tolerance, store=STORE)
            print(f"{folder.name}: {f'{len(found)} differences' if found else 'holds'}")
            print(*(f"  {one}" for one in found[:10]), sep="\n")
            sys.exit(1 if found else 0)
        if asked.redraw:
            run = read_run(folder, out)
        else:
            run = Run(folder.name, asked.quick, out, STORE)
            tables(run)
            run.write_record()
        with plots.figure_settings():
            page(run).write(out / "report.md")
    except KeyboardInterrupt:
        print("interrupted: tables and evaluations are kept, run it again", file=sys.stderr)
        sys.exit(130)
    print(f"{folder.name}: {len(run.tables)} tables and report.md in {out}")


def read_run(folder: Path, out: Path | None = None) -> Run:
    """Read the tables and the record of a study that has been run; `out` is where to draw."""
    run = Run(folder.name, out=out)
    results = folder / "results"
    run.record = json.loads((results / "record.json").read_text(encoding="utf-8"))
    for entry in run.record["tables"]:
        run.tables[entry["name"]] = _read(results / f"{entry['name']}.csv")
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
    problems = run.tables["problems"]
    known = problems[problems["reference_kind"] != ""]
    if not known.empty:
        page.section("References")
    for how, rows in known.groupby("reference_how", sort=False):
        names = ", ".join(f"`{name}`" for name in rows["problem"])
        page.text(f"{names}: {how} Made by `{rows['reference_command'].iloc[0]}`.")
    said = [frame for frame in run.tables.values() if "error_kind" in frame and "pf_low" in frame]
    if said:
        page.section("What the methods say of their own answers")
        rows = pd.concat(said, ignore_index=True)
        rows = rows[rows["status"] != "converged"]
        unsaid = "nobody estimated the error of the answer"
        rows["message"] = rows["message"].where(rows["message"] != "", unsaid)
        counts = rows.groupby(["label", "status", "message"], sort=False).size()
        page.table(
            counts.sort_values(ascending=False, kind="stable").head(12).reset_index(name="rows"),
            "Answers that are not converged",
            f"{len(counts)} different messages in all." if len(counts) > 12 else "",
        )
    page.section("How it was made")
    versions = ", ".join(f"{name} {one}" for name, one in run.record["versions"].items())
    page.text(f"`{run.record.get('command', '')}`, {run.record['date']}; {versions}")
    page.table(
        pd.DataFrame(run.record["tables"], columns=["name", "rows", "seconds", "date"]),
        "Tables, in results/",
        "Seconds are of the run that made them; kept evaluations take none.",
    )
    page.text("\n".join(f"- `{label}`: `{method!r}`" for label, method in methods.items()))
    return page


INDEX = (
    "problem", "label", "other", "parameter", "input", "moment", "order", "units", "relative",
    "threshold", "tau", "missions", "target_pf", "step", "theta_1_initial", "x_lock",
)  # fmt: skip
"""Columns that tell the rows of a table apart, besides budget and seed."""
SAMPLE = (
    "seed", "n_evals", "sampled_responses", "draws", "repeats", "verified_n_evals", "seconds",
)  # fmt: skip
"""Columns whose values say together whether two rows come from the same sample."""
ERROR_OF = {
    "per_std": "per_std_error", "elasticity": "elasticity_error", "pf_mean": "pf_std",
    "sampled_difference": "sampled_std_error",
}  # fmt: skip
OWNERS = ("derivative", "index", "difference", "value", "pf")
"""The first of these that a table has is the estimate that ``std_error`` belongs to."""
SAMPLED = (
    "reliability", "beta", "error", "ci_low", "ci_high", "pf_low", "pf_high", "low", "high", "safe",
    "value_pf", "value_ci_low", "value_ci_high", "safe_pf", "safe_ci_low", "safe_ci_high",
    "response_mean", "response_std",
)  # fmt: skip
"""Columns besides that depend on the sample; pf does in tables that have a ``std_error``."""
DERIVED = ("beta", "error")
"""Columns that follow from others, and magnify their rounding where they are close to zero."""
STANDARD_ERRORS = 5.0
ADAPTIVE = ("active-kriging", "ak-mcs")
"""Methods that choose their own runs: their rows always count as another sample."""


def differences(
    folder: Path, tables: Tables, tolerance: tuple[float, float], store: Path | None = None
) -> list[str]:
    """Compare the reduced form of a study with its committed tables; return what differs."""
    committed, fresh = read_run(folder), Run(folder.name, quick=True, store=store)
    tables(fresh)
    found = [f"{name}: not made" for name in committed.tables if name not in fresh.tables]
    for name, frame in fresh.tables.items():
        found += [f"{name}: {one}" for one in compared(committed.tables[name], frame, tolerance)]
    return found


def compared(
    committed: pd.DataFrame, fresh: pd.DataFrame, tolerance: tuple[float, float]
) -> Iterator[str]:
    """Hold fresh rows against committed ones, and say what differs.

    A fresh row is compared with the committed row of the same index, budget and seed, or else of
    the same index. Numbers from the same sample have to agree to the tolerance, estimates from
    another one in their joint standard errors: methods that choose their own evaluations take
    another sample wherever sums round differently.
    """
    index = [name for name in INDEX if name in fresh]
    exact = [*index, *(name for name in ("max_evals", "seed") if name in fresh)]
    known = {_key(row, exact): row for row in committed.to_dict("records")}
    alike = {_key(row, index): row for row in known.values()}
    errors = {name: error for name, error in ERROR_OF.items() if name in fresh}
    if "std_error" in fresh:
        errors[next(name for name in OWNERS if name in fresh)] = "std_error"
    sampled = {*errors, *errors.values(), *SAMPLED, *(["pf"] if "std_error" in fresh else [])}
    numbers = fresh.select_dtypes("float").columns.difference([*exact, *DERIVED])
    for row in fresh.to_dict("records"):
        where = ", ".join(f"{name} = {row[name]}" for name in exact)
        partner = known.get(_key(row, exact)) or alike.get(_key(row, index))
        if partner is None:
            yield f"{where}: not among the committed rows"
            continue
        sample = [name for name in SAMPLE if name in fresh]
        same = _key(row, sample) == _key(partner, sample) and row.get("label") not in ADAPTIVE
        for name in numbers.difference([*SAMPLE, *([] if same else sampled)]):
            if not _close(row[name], partner[name], tolerance):
                yield f"{where}: {name} = {row[name]!r}, committed {partner[name]!r}"
        for name, error in ({} if same else errors).items():
            joint = math.hypot(row[error], partner[error])
            if abs(row[name] - partner[name]) > STANDARD_ERRORS * joint:
                yield f"{where}: {name} = {row[name]!r}, committed {partner[name]!r} ± {joint:.2g}"


def _key(row: Mapping[Any, Any], names: Collection[str]) -> tuple[Any, ...]:
    values = (row[name] for name in names)
    return tuple(None if isinstance(one, float) and math.isnan(one) else one for one in values)


def _close(one: float, other: float, tolerance: tuple[float, float]) -> bool:
    both_missing = math.isnan(one) and math.isnan(other)
    return both_missing or math.isclose(one, other, rel_tol=tolerance[0], abs_tol=tolerance[1])


TEXTS = (
    "missions", "message", "unit", "response_unit", "ci_kind", "reference_kind", "reference_how",
    "reference_command", "verified_by", "value_meets", "safe_meets", "agrees",
)  # fmt: skip
"""Columns of texts that may all be empty, or look like numbers."""


def _read(path: Path) -> pd.DataFrame:
    """Read a table: columns of numbers where every cell is one, else texts."""
    with path.open(encoding="utf-8", newline="") as file:
        head, *lines = csv.reader(file)
    frame = pd.DataFrame(lines, columns=head)
    for name in frame.columns.difference(TEXTS):
        try:
            frame[name] = frame[name].map(int)
        except ValueError:
            try:
                frame[name] = [float(cell or "nan") for cell in frame[name]]
            except ValueError:
                continue
    return frame


def _write(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
