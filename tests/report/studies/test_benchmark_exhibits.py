"""Figure and tables of the benchmark of methods."""

import math

import pandas as pd
import pytest

from uqfold.comparison.benchmark import NEEDS
from uqfold.report.studies.registry import figure_kinds, table_kinds
from uqfold.report.studies.selection import SelectionError


def runs() -> pd.DataFrame:
    rows = []
    for label, error in (("kriging", 0.01), ("mc", 0.3), ("pce", 0.02)):
        for budget in (100.0, 1125.0):
            for seed in (0, 1):
                for reference in (0.05, 5e-4):
                    pf = reference * (1.0 + error * (1 if seed else -1) * 100.0 / budget)
                    if label == "mc" and reference < 1e-3 and budget < 200:
                        pf = math.nan
                    rows.append(
                        {
                            "problem": "toy", "label": label, "max_evals": budget,
                            "threshold": reference, "tau": math.nan, "missions": "1", "seed": seed,
                            "pf": pf, "std_error": error * reference, "ci_low": 0.0, "ci_high": 1.0,
                            "status": "converged", "n_evals": int(budget),
                            "reference_pf": reference, "reference_std_error": 0.0, "method": label,
                        }
                    )  # fmt: skip
    return pd.DataFrame(rows)


TABLES = {"problems": pd.DataFrame({"problem": ["toy"], "units": [4]}), "runs": runs()}


def test_ranking_by_error() -> None:
    assert set(NEEDS) <= set(TABLES["runs"].columns)
    table = table_kinds()["ranking"].call({"table": ("runs",), "places": 3}, TABLES)
    first = table.iloc[0]
    assert (first["reference pf"], first["budget"]) == ("1e-2 to 1e-1", "100")
    assert [first["1."], first["2."], first["3."]] == ["kriging 1.0 %", "pce 2.0 %", "mc 30.0 %"]
    # mc does not answer everything at 100 evaluations in the lower decade
    low = table[(table["reference pf"] == "1e-4 to 1e-3") & (table["budget"] == "100")].iloc[0]
    assert low["3."] == "-"


def test_trust_counts_answers_and_errors() -> None:
    table = table_kinds()["trust"].call({"table": ("runs",)}, TABLES)
    row = table[(table["method"] == "mc") & (table["budget"] == "100")].iloc[0]
    assert row["answered"] == "50 %"
    assert row["error found / error stated"] == "1"
    assert row["intervals that hold the reference"] == "100 %"


def test_seconds() -> None:
    frame = pd.DataFrame(
        {"label": ["mc", "mc"], "max_evals": [100.0, 1125.0], "seconds": [0.002, math.nan]}
    )
    table = table_kinds()["seconds"].call({"table": ("timing",)}, {"timing": frame})
    assert table.iloc[0].tolist() == ["mc", "2.0 ms", "-"]


def test_figure_of_errors() -> None:
    settings = {"table": ("runs",), "decades": (-2.0, -4.0), "synchronized": False}
    figure = figure_kinds()["budgets"].call(settings, TABLES)
    assert len(figure.axes) == 2
    drawn = [line.get_xdata().tolist() for line in figure.axes[0].lines if line.get_marker() == "P"]
    assert [100.0, 1125.0] in drawn
    assert not any(axes.texts for axes in figure.axes)
    with pytest.raises(SelectionError, match="no reference lies"):
        figure_kinds()["budgets"].call({**settings, "decades": (-9.0,)}, TABLES)
    # where one decade of several was not asked, the panel says so
    empty = figure_kinds()["budgets"].call({**settings, "decades": (-2.0, -9.0)}, TABLES).axes[1]
    assert [text.get_text() for text in empty.texts] == ["not asked"]
