"""Reference tables: schema, lookup without interpolation, and the files that ship."""

import copy
import math
from collections.abc import Callable
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

import pytest

from uqfold.problems import Problem, folding_wing, four_bar, series
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.reference import SCHEMA, load_references, parse_references

DOCUMENT: dict[str, Any] = {
    "schema": SCHEMA,
    "problem": "p",
    "kind": "integration",
    "how": "by hand",
    "command": "none",
    "rows": [
        {"threshold": 1.0, "tau": None, "missions": 1, "pf": 0.25, "std_error": 1e-9},
        {
            "threshold": 1.0,
            "tau": 0.5,
            "missions": {"planned": 10, "p": 0.7},
            "pf": 0.5,
            "std_error": 0.0,
        },
    ],
}


def changed(**changes: Any) -> dict[str, Any]:
    """The document with fields of its first row replaced; ``...`` takes a field away."""
    document = copy.deepcopy(DOCUMENT)
    for name, value in changes.items():
        if value is ...:
            del document["rows"][0][name]
        else:
            document["rows"][0][name] = value
    return document


def test_a_document_becomes_a_table() -> None:
    table = parse_references(DOCUMENT)
    assert (table.problem, table.kind, table.how, table.command) == (
        "p",
        "integration",
        "by hand",
        "none",
    )
    assert len(table) == 2
    assert [row.pf for row in table] == [0.25, 0.5]
    row = table.lookup(Criterion(1.0, 0.5, Binomial(10, 0.7)))
    assert row is not None
    assert (row.pf, row.std_error) == (0.5, 0.0)


@pytest.mark.parametrize(
    "criterion",
    [
        Criterion(math.nextafter(1.0, 2.0)),
        Criterion(1.5),
        Criterion(1.0, 0.0),
        Criterion(1.0, None, 2),
        Criterion(1.0, None, Binomial(1, 1.0)),
        Criterion(1.0, 0.5, Binomial(10, 0.5)),
    ],
)
def test_nothing_is_interpolated(criterion: Criterion) -> None:
    assert parse_references(DOCUMENT).lookup(criterion) is None


@pytest.mark.parametrize("schema", [None, "uqfold-reference/2", 1])
def test_another_schema_is_refused(schema: object) -> None:
    with pytest.raises(ValueError, match="is not 'uqfold-reference/1'"):
        parse_references({**DOCUMENT, "schema": schema})


@pytest.mark.parametrize("field", ["problem", "kind", "how", "command", "rows"])
def test_a_missing_field_is_named(field: str) -> None:
    document = {name: value for name, value in DOCUMENT.items() if name != field}
    with pytest.raises(ValueError, match=f"lacks the field '{field}'"):
        parse_references(document)


@pytest.mark.parametrize("field", ["threshold", "tau", "missions", "pf", "std_error"])
def test_a_missing_field_of_a_row_is_named(field: str) -> None:
    with pytest.raises(ValueError, match=f"lacks the field '{field}'"):
        parse_references(changed(**{field: ...}))


@pytest.mark.parametrize(
    "change",
    [
        {"pf": -1e-12},
        {"pf": 1.0 + 1e-12},
        {"pf": math.nan},
        {"pf": None},
        {"pf": "much"},
        {"std_error": -1e-9},
        {"std_error": math.nan},
        {"std_error": math.inf},
        {"threshold": math.nan},
        {"threshold": None},
        {"tau": -0.1},
        {"missions": 1.5},
        {"missions": 0},
        {"missions": None},
        {"missions": {"planned": 2.5, "p": 0.5}},
        {"missions": {"planned": 2, "p": 1.5}},
        {"missions": {"planned": 2}},
    ],
    ids=str,
)
def test_impossible_rows_are_refused(change: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"."):
        parse_references(changed(**change))


def test_two_answers_to_one_criterion_are_refused() -> None:
    document = copy.deepcopy(DOCUMENT)
    document["rows"].append({**document["rows"][0], "pf": 0.26})
    with pytest.raises(ValueError, match="two references for T = 1, m = 1"):
        parse_references(document)


SHIPPED: dict[str, Callable[[], Problem]] = {
    "series": series,
    "four_bar": four_bar,
    "four_bar_crossed": partial(four_bar, "crossed"),
    "folding_wing": folding_wing,
}
ROOT = Path(__file__).resolve().parents[2]


FOLDER = Path(str(resources.files("uqfold.problems") / "references"))


@pytest.mark.parametrize("path", sorted(FOLDER.iterdir()), ids=lambda path: path.name)
def test_shipped_file_states_where_it_comes_from(path: Path) -> None:
    table = load_references(path.stem)
    assert path.name == f"{path.stem}.json"
    assert table.kind in {"integration", "simulation", "closed-form"}
    assert len(table) > 0
    assert len(table.how) > 40
    python, script, *_ = table.command.split()
    assert python == "python"
    assert (ROOT / script).is_file()
    assert path.stat().st_size < 500_000


@pytest.mark.parametrize("name", list(SHIPPED))
def test_problem_carries_its_references(name: str) -> None:
    assert SHIPPED[name]().references == load_references(name)
    assert load_references(name).problem == SHIPPED[name]().name
    assert load_references(name).kind == ("simulation" if name == "folding_wing" else "integration")


@pytest.mark.parametrize("name", list(SHIPPED))
def test_default_criteria_have_references(name: str) -> None:
    default = SHIPPED[name]().default_criteria
    assert default is not None
    rows = [load_references(name).lookup(criterion) for criterion in default]
    assert None not in rows
    pf = [row.pf for row in rows if row is not None and row.criterion.tau is None]
    assert 0.4 < max(pf) < 0.6
    assert min(pf) < (5e-3 if name == "folding_wing" else 1.5e-6)
    # under tau the curve reaches a plateau that is not negligible
    plateau = [row.pf for row in rows if row is not None and row.criterion.tau is not None]
    assert plateau == sorted(plateau, reverse=True)
    assert plateau[-1] > 3 * pf[-1]
    assert plateau[-1] / plateau[-2] > 3 * pf[-1] / pf[-2]


@pytest.mark.parametrize("name", list(SHIPPED))
def test_shipped_rows_fit_together(name: str) -> None:
    """Order in T, tau and m, within the errors of the rows."""
    table = load_references(name)
    fixed = [row for row in table if not isinstance(row.criterion.missions, Binomial)]
    by_key = {(r.criterion.threshold, r.criterion.tau, r.criterion.missions): r for r in fixed}
    thresholds, taus, missions = (
        sorted(set(values), key=_last_none) for values in zip(*by_key, strict=True)
    )

    def ordered(lower: Any, higher: Any) -> bool:
        if lower is None or higher is None:
            return True
        return bool(lower.pf <= higher.pf + 4 * math.hypot(lower.std_error, higher.std_error))

    compared = 0
    for (threshold, tau, m), row in by_key.items():
        for axis, values, position in (
            (0, thresholds, thresholds.index(threshold)),
            (1, taus, taus.index(tau)),
            (2, missions, missions.index(m)),
        ):
            if position + 1 == len(values):
                continue
            key = [threshold, tau, m]
            key[axis] = values[position + 1]
            following = by_key.get(tuple(key))
            compared += following is not None
            pair = (row, following) if axis == 2 else (following, row)
            assert ordered(*pair), (row, following)
    assert compared > len(by_key)


def _last_none(value: float | None) -> float:
    return math.inf if value is None else value


@pytest.mark.parametrize("name", ["series", "four_bar", "four_bar_crossed"])
def test_binomial_rows_follow_from_the_fixed_ones(name: str) -> None:
    # total probability over the number of missions, 0, 1 or 2
    table = load_references(name)
    binomial = [row for row in table if row.criterion.missions == Binomial(2, 0.5)]
    assert len(binomial) > 100
    for row in binomial:
        c = row.criterion
        one, two = (table.lookup(Criterion(c.threshold, c.tau, m)) for m in (1, 2))
        assert one is not None
        assert two is not None
        assert row.pf == pytest.approx(0.5 * one.pf + 0.25 * two.pf, rel=1e-6)


def test_the_wing_of_other_parameters_has_no_references() -> None:
    from uqfold.mechanism import WingParameters

    assert folding_wing(WingParameters(C_f=0.05)).references is None


def test_loading_twice_reads_once() -> None:
    assert load_references("series") is load_references("series")
