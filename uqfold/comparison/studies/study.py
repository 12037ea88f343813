"""A study: what its file may say, and what it is once it has been read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from uqfold.comparison.columns import COLUMNS
from uqfold.comparison.studies.builtin import BUILT_IN, INPUTS, PROBLEMS
from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, SEEDS, TAUS
from uqfold.comparison.studies.keys import (
    COUNT,
    MAPPING,
    NUMBER,
    TABLES,
    TEXT,
    Key,
    Kind,
    RowIdentity,
    choice,
    list_of,
)
from uqfold.comparison.studies.problems import ProblemSpec
from uqfold.methods.base import ReliabilityMethod
from uqfold.problems.criterion import Criteria

SCHEMA = "uqfold-study/1"
FILE_NAME = "study.toml"
RUN_COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    "max_evals": float,
    **{name: kind for name, kind in COLUMNS.items() if name not in {"seconds", "n_reused"}},
}
"""Columns of the table of a run: those of a comparison with the budget, the problem by its name in
the study, and without what changes from one run to the next."""

RUN_IDENTITY = RowIdentity(
    index=("problem", "label", "threshold", "tau", "missions", "max_evals", "seed"),
    # a budget changes the sample only if it is used up
    sample=("seed", "n_evals"),
    estimates={"pf": "std_error"},
    sampled=("reliability", "ci_low", "ci_high", "pf_low", "pf_high"),
)

STUDY_KEYS = (
    Key("schema", choice(SCHEMA), "Schema of the file."),
    Key("title", TEXT, "Title of the report."),
    Key("question", TEXT, "What the study answers; opens the report."),
    Key("notes", TEXT, "What a reader has to know besides: choices made, sources.", ""),
    Key("problems", MAPPING, "Name -> problem: `[problems.NAME]`."),
    Key("methods", MAPPING, "Label -> method with settings: `[methods.LABEL]`.", {}),
    Key("check", MAPPING, "Tolerances of `study check`: `[check]`.", {}),
    Key("run", TABLES, "Comparisons of methods: `[[run]]`.", ()),
    Key("analysis", TABLES, "Work of another kind: `[[analysis]]`.", ()),
    Key("table", TABLES, "Tables of the report: `[[table]]`.", ()),
    Key("figure", TABLES, "Figures of the report: `[[figure]]`.", ()),
)
METHOD_KEYS = (
    Key("method", TEXT, "Registered name, as `uqfold methods` lists it."),
    Key("settings", MAPPING, "Settings of the method, as its class documents them.", {}),
)
CHECK_KEYS = (
    Key("relative", NUMBER, "Largest relative difference of numbers without random error.", 1e-6),
    Key("absolute", NUMBER, "Difference below which two numbers are the same.", 1e-12),
    Key("standard_errors", NUMBER, "Largest difference of estimates from other samples.", 5.0),
)
QUICK = Key("quick", MAPPING, "Keys that the reduced form (`--quick`) replaces.", {})
RUN_KEYS = (
    Key("name", TEXT, "Name of the table, unique in the study."),
    Key("problem", list_of(TEXT), "Problems, by name."),
    Key("methods", list_of(TEXT), "Labels of `[methods]`, or registered names."),
    Key("thresholds", NUMBERS, "Thresholds T."),
    Key("tau", TAUS, "Synchronization thresholds.", (None,)),
    Key("missions", MISSIONS, "Mission profiles.", (1,)),
    Key("max_evals", list_of(COUNT), "Budgets; each method runs once with each.", (None,)),
    Key("seeds", SEEDS, "Seeds; a method without randomness runs with the first alone.", (0,)),
    QUICK,
)
METHOD_KEYS_OF_ANALYSES = ("method", "methods", "verify")
"""Keys of an analysis that hold labels of methods, whatever its kind."""
ANALYSIS_KEYS = (
    Key("name", TEXT, "Name of the table, unique in the study."),
    Key("kind", TEXT, "Which kind."),
    QUICK,
)
EXHIBIT_KEYS = (
    Key("name", TEXT, "Name of the files, unique in the study."),
    Key("kind", TEXT, "Which kind."),
    Key("title", TEXT, "Title, for instance `Fig. 12(a)`.", ""),
    Key("caption", TEXT, "What stands below it.", ""),
)


@dataclass(frozen=True)
class RunSpec:
    """One comparison: every problem with every method, budget and seed on one grid."""

    name: str
    problems: tuple[str, ...]
    methods: tuple[str, ...]
    criteria: Criteria
    budgets: tuple[int | None, ...]
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Spec:
    """An analysis, figure or table: its name, its kind, and the values of the kind's keys."""

    name: str
    kind: Kind
    settings: Mapping[str, Any]
    title: str = ""
    caption: str = ""


@dataclass(frozen=True)
class Study:
    """A checked study.

    Attributes
    ----------
    folder
        Where its file lies.
    title, question, notes
        What the report says first.
    problems
        Name -> problem.
    methods
        Label -> method.
    runs, analyses
        What makes its tables.
    tables, figures
        What shows them.
    check
        Values of `CHECK_KEYS`.
    digest
        SHA-256 of what it asks for: problems, methods, runs and analyses.
    quick
        Whether this is the reduced form.
    """

    folder: Path
    title: str
    question: str
    notes: str
    problems: Mapping[str, ProblemSpec]
    methods: Mapping[str, ReliabilityMethod]
    runs: tuple[RunSpec, ...]
    analyses: tuple[Spec, ...]
    tables: tuple[Spec, ...]
    figures: tuple[Spec, ...]
    check: Mapping[str, float]
    digest: str
    quick: bool

    @property
    def columns(self) -> dict[str, Mapping[str, type]]:
        """Name -> columns and their types of every table of runs and analyses."""
        return {
            **BUILT_IN,
            **{run.name: RUN_COLUMNS for run in self.runs},
            **{analysis.name: analysis.kind.columns for analysis in self.analyses},
        }

    @property
    def identities(self) -> dict[str, RowIdentity]:
        """Name -> what identifies a row of every table."""
        return {
            PROBLEMS: RowIdentity(("problem",)),
            INPUTS: RowIdentity(("problem", "input")),
            **{run.name: RUN_IDENTITY for run in self.runs},
            **{analysis.name: analysis.kind.identity for analysis in self.analyses},
        }
