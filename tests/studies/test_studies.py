"""Every study: its committed tables are what a fresh reduced run gives, and are all shown."""

import importlib.util
import math
import re
import sys
from html import unescape
from pathlib import Path
from types import ModuleType
from typing import Any

import pandas as pd
import pytest
from matplotlib.figure import Figure

import uqfold
from uqfold import plots
from uqfold.report import Page

STUDIES = Path(__file__).parents[2] / "studies"
sys.path.append(str(STUDIES))
import runner  # noqa: E402

FOLDERS = sorted(path.parent for path in STUDIES.glob("*/study.py"))


def loaded(folder: Path) -> ModuleType:
    """Import the script of a study without running it."""
    sys.path.insert(0, str(folder))
    try:
        name = f"study_{folder.name.replace('-', '_')}"
        spec = importlib.util.spec_from_file_location(name, folder / "study.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(folder))
    return module


@pytest.mark.slow
@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_committed_tables_are_reproduced(folder: Path, tmp_path: Path) -> None:
    """`.ci/run` asks this beside the default tests."""
    # a store of its own: nothing that an earlier run left is taken for a fresh result
    study = loaded(folder)
    store = uqfold.evaluation.Store(tmp_path / "evaluations.db")
    kept = runner.read_run(folder, study.PROBLEMS)
    assert runner.differences(kept, study.tables, study.TOLERANCE, store) == []


Asked = dict[str, Any]
"""Options of `plots.reliability_panels`, and the rows that it was to draw."""


def shown(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Page, dict[str, Asked]]:
    """Make a page from committed tables; its curves are not drawn, but what they show is kept."""
    asked: dict[int, Asked] = {}
    figures: list[Figure] = []

    def kept(frame: pd.DataFrame, quantities: Any = ("reliability",), **options: Any) -> Figure:
        figures.append(Figure())
        asked[id(figures[-1])] = {"rows": frame, "quantities": quantities, **options}
        return figures[-1]

    monkeypatch.setattr(plots, "reliability_panels", kept)
    study = loaded(folder)
    page = study.page(runner.read_run(folder, study.PROBLEMS))
    named = page.pictures
    return page, {name: asked[id(one)] for name, one in named.items() if id(one) in asked}


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_committed_tables_are_small_and_all_read(folder: Path) -> None:
    """Repeated runs are kept as one row per case, not one row per seed."""
    sizes = {path.stem: path.stat().st_size for path in folder.glob("results/*.csv")}
    assert set(sizes) == set(runner.read_run(folder, {}).tables)
    assert max(sizes.values()) < 150_000


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_the_report_shows_every_figure(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page, _ = shown(folder, monkeypatch)
    report = (folder / "report.md").read_text(encoding="utf-8")
    names = set(page.pictures)
    assert names == {path.stem for path in folder.glob("figures/*.png")}
    assert all(f"figures/{name}.png" in report for name in names)
    assert unescape(report.splitlines()[0]) == f"# {page.title}"


@pytest.mark.parametrize(
    ("study", "names"),
    [
        ("example-1", ["fig-12b", "fig-12c"]),
        ("example-2", ["fig-14b-open", "fig-14b-crossed", "fig-14c-open", "fig-14c-crossed"]),
    ],
)
def test_simulated_curves_stand_beside_several_missions_and_synchronization(
    study: str, names: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    _, asked = shown(STUDIES / study, monkeypatch)
    for name in names:
        simulated = asked[name]["rows"].query("label == 'mc'")
        assert len(simulated) > 10
        assert simulated["pf"].notna().all()


@pytest.mark.parametrize(
    ("study", "names"),
    [("example-4", ["fig-16i", "fig-16j"]), ("example-5", ["fig-17i", "fig-17j"])],
)
def test_conditions_that_nearly_coincide_have_a_panel_of_their_difference(
    study: str, names: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    _, asked = shown(STUDIES / study, monkeypatch)
    assert all("difference" in asked[name]["quantities"] for name in names)


def test_table_7_has_a_row_of_the_simulation_behind_the_reference() -> None:
    """Example 3 has no Monte Carlo of its own: that of the reference is named with its runs."""
    report = (STUDIES / "example-3" / "report.md").read_text(encoding="utf-8")
    assert re.search(r"Monte Carlo, the reference \| [\d,]{7,}", report)


RUNS = pd.DataFrame(
    {"problem": "p", "label": ["mc", "ffni-spa"], "max_evals": math.nan, "threshold": 1.0,
     "tau": math.nan, "missions": "1", "pf": [0.1, 0.2], "std_error": [0.01, math.nan],
     "n_evals": [100, 75], "seed": 0, "reference_pf": 0.15}
)  # fmt: skip
INDEPENDENCE = pd.DataFrame(
    {"problem": "p", "units": [2], "threshold": 1.0, "pf": 0.1, "sampled_responses": 64.0,
     "sampled_difference": 0.01, "sampled_std_error": 0.002}
)  # fmt: skip


@pytest.mark.parametrize(
    ("table", "row", "change", "said"),
    [
        (RUNS, 0, {}, ""),
        # the same sample: to the tolerance
        (RUNS, 0, {"pf": 0.1 * (1 + 1e-7)}, ""),
        (RUNS, 0, {"pf": 0.1 * (1 + 1e-5)}, "pf = "),
        (RUNS, 1, {"pf": math.nan}, "pf = nan"),
        (RUNS, 1, {"std_error": 0.1}, "std_error = 0.1, committed nan"),
        # another sample: in joint standard errors, and what depends on no sample exactly
        (RUNS, 0, {"seed": 1, "pf": 0.15}, ""),
        (RUNS, 0, {"seed": 1, "pf": 0.19}, "± 0.071"),
        (RUNS, 0, {"n_evals": 99, "pf": 0.15, "std_error": 0.02}, ""),
        (RUNS, 0, {"seed": 1, "reference_pf": 0.16}, "reference_pf = 0.16"),
        (RUNS, 0, {"threshold": 2.0}, "not among the committed rows"),
        # a method that chooses its own evaluations never has the same sample
        (RUNS.replace("mc", "active-kriging"), 0, {"pf": 0.11}, ""),
        # only the sampled part of this table depends on the sample
        (INDEPENDENCE, 0, {"sampled_responses": 32.0, "sampled_difference": 0.012}, ""),
        (INDEPENDENCE, 0, {"sampled_responses": 32.0, "sampled_difference": 0.03}, "± 0.014"),
        (INDEPENDENCE, 0, {"sampled_responses": 32.0, "pf": 0.101}, "pf = 0.101"),
    ],
)
def test_a_check_says_what_differs(
    table: pd.DataFrame, row: int, change: dict[str, float], said: str
) -> None:
    fresh = table.copy()
    for column, value in change.items():
        fresh.loc[row, column] = value
    found = list(runner.compared(table, fresh, (1e-6, 1e-12)))
    assert len(found) == bool(said)
    assert said in "".join(found)


@pytest.mark.thorough
def test_a_study_runs_redraws_and_checks_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tables, record, figures and report come from one command; a spoilt table is found."""
    study = loaded(STUDIES / "example-1")
    script = tmp_path / "example-1" / "study.py"

    def run(option: str) -> None:
        monkeypatch.setattr(sys, "argv", ["study.py", option])
        runner.main(str(script), study.PROBLEMS, study.tables, study.page, study.TOLERANCE)

    monkeypatch.setattr(runner, "STORE", tmp_path / "evaluations.db")
    run("--quick")
    for option in ("--check", "--redraw"):
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            run(option)
        assert ended.value.code == 2
        (said,) = capsys.readouterr().err.splitlines()
        assert "there is no results/record.json: run it in full first" in said
    (tmp_path / ".quick" / "example-1").rename(script.parent)
    assert runner.read_run(script.parent, {}).record["quick"] is True
    assert len(list(script.parent.glob("figures/*.png"))) == 5
    report = script.parent / "report.md"
    drawn = report.read_text()
    assert "Reduced form" in drawn
    report.unlink()
    run("--redraw")
    assert report.read_text() == drawn
    with pytest.raises(SystemExit) as ended:
        run("--check")
    assert ended.value.code == 0
    table = script.parent / "results" / "sync.csv"
    table.write_text(table.read_text().replace("ffni-pearson,,0,12", "ffni-pearson,,0.5,12"))
    with pytest.raises(SystemExit) as ended:
        run("--check")
    assert ended.value.code == 1
    assert "not among the committed rows" in capsys.readouterr().out
    kept = runner.read_run(script.parent, study.PROBLEMS)
    kept.tables.pop("sync")
    found = runner.differences(kept, study.tables, study.TOLERANCE)
    assert "sync: not among both committed and fresh tables" in found
