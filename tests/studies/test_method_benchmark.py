"""The method benchmark: runs, and its summary is right."""

import runpy
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

SCRIPT = Path(__file__).parents[2] / "studies" / "method_benchmark" / "benchmark.py"


def test_runs_and_writes_its_tables(tmp_path: Path) -> None:
    words = ["--seeds", "3", "--max-evals", "2000", "--out", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, "-W", "error", str(SCRIPT), *words],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    table = pd.read_csv(tmp_path / "summary.csv")
    assert len(done.stdout.splitlines()) == len(table) + 1
    runs = dict(zip(table["label"], table["runs"], strict=True))
    assert runs == {
        "ffni-spa": 1,
        "ffni-pearson": 1,
        "kriging": 3,
        "pce": 3,
        "ak-mcs": 3,
        "mc": 3,
        "conditional-mc": 3,
        "openturns-form": 1,
        "openturns-mc": 3,
    }
    spa = table[table["label"] == "ffni-spa"]
    assert list(spa["n_evals_row"]) == [75] * 3
    assert (spa["bias"].abs() < 0.03).all()
    assert set(pd.read_csv(tmp_path / "runs.csv")["seed"]) == {0, 1, 2}


def test_summary_of_known_runs() -> None:
    runs = pd.DataFrame(
        {
            "threshold": 1.0,
            "label": "m",
            "pf": [0.08, 0.14, float("nan")],
            "reference_pf": 0.1,
            "ci_low": [0.05, 0.11, float("nan")],
            "ci_high": [0.12, 0.16, float("nan")],
            "n_evals_row": [100, 300, 999],
        }
    )
    (row,) = runpy.run_path(str(SCRIPT))["summary"](runs).to_dict("records")
    assert row == {
        "threshold": 1.0,
        "label": "m",
        "runs": 2.0,
        "bias": pytest.approx(0.1),
        "bias_std_error": pytest.approx(0.3),
        "rmse": pytest.approx((0.5 * (0.2**2 + 0.4**2)) ** 0.5),
        "coverage": 0.5,
        "n_evals_row": 200.0,
    }


def test_no_seeds_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    main = runpy.run_path(str(SCRIPT))["main"]
    with pytest.raises(SystemExit):
        main(["--seeds", "0"])
    assert "--seeds 0: give at least 1" in capsys.readouterr().err
