"""Full disks and lost power: the run goes on from what was committed, and no number is wrong."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.evaluation import models
from uqfold.evaluation import Evaluator, Store, StoreError
from uqfold.methods import MonteCarlo
from uqfold.problems.criterion import criteria

ASKED = criteria([1.0, 2.0])
SECTOR = 512


def estimate(store: Store | Path | None) -> list[dict[str, object]]:
    result = MonteCarlo(systems=20_000).estimate(
        models.problem(), ASKED, rng=4, evaluator=Evaluator(store=store)
    )
    return [{**row, "seconds": 0.0} for row in result.to_records()]


@pytest.fixture(scope="module")
def expected() -> list[dict[str, object]]:
    return estimate(None)


def check_resumed(path: Path, expected: list[dict[str, object]], kept: int) -> None:
    again = estimate(path)
    assert again[0]["n_reused"] == kept
    assert [{**row, "n_reused": 0} for row in again] == expected


def test_a_run_stopped_by_a_full_disk_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, expected: list[dict[str, object]]
) -> None:
    monkeypatch.setattr("uqfold.evaluation.shelf.WORTH_A_COMMIT_SECONDS", 0.0)
    path = tmp_path / "runs.db"
    with Store(path) as store:
        store._connection.execute("PRAGMA max_page_count = 40")
        with pytest.raises(StoreError, match="the disk is full: what was committed is kept"):
            estimate(store)
    with Store(path) as store:
        kept = len(store)
    # whole batches of 4,096 rows
    assert 0 < kept < 20_000
    assert kept % 4096 == 0
    check_resumed(path, expected, kept)


PROGRAM = """
import json, resource, sys
from pathlib import Path
from tests.evaluation.test_power_loss import estimate
from uqfold.evaluation import StoreError, shelf

shelf.WORTH_A_COMMIT_SECONDS = 0.0
Path(sys.argv[1]).touch()
resource.setrlimit(resource.RLIMIT_FSIZE, (120_000, resource.RLIM_INFINITY))
try:
    estimate(Path(sys.argv[1]))
except StoreError as error:
    print(json.dumps(str(error)))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs setrlimit")
def test_a_quota_is_an_error_and_the_run_goes_on(
    tmp_path: Path, expected: list[dict[str, object]]
) -> None:
    path = tmp_path / "runs.db"
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(path)],
        capture_output=True, text=True, check=True, timeout=120, cwd=Path(__file__).parents[2],
    )  # fmt: skip
    assert "cannot be read or written" in json.loads(done.stdout)
    with Store(path) as store:
        kept = len(store)
    assert 0 < kept < 20_000
    check_resumed(path, expected, kept)


@pytest.fixture(scope="module")
def after_commits(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, np.ndarray, np.ndarray]:
    """Copies of the file and its log as they lie on the disk after twelve commits."""
    folder = tmp_path_factory.mktemp("store")
    x = models.rows(12 * 64)
    with Store(folder / "live.db") as store:
        for part in x.reshape(12, 64, -1):
            Evaluator(store=store).open(models.problem(), None).evaluate(part)
        for end in ("", "-wal"):
            shutil.copy(folder / f"live.db{end}", folder / f"runs.db{end}")
    return folder, x, models.quadratic(x)


@pytest.mark.parametrize("damage", ["cut", "zeroed", "flipped"])
def test_a_torn_log_costs_runs_and_gives_no_wrong_number(
    after_commits: tuple[Path, np.ndarray, np.ndarray], tmp_path: Path, damage: str
) -> None:
    folder, x, right = after_commits
    log = (folder / "runs.db-wal").read_bytes()
    rng = np.random.default_rng(5)
    kept = []
    for place in rng.integers(0, len(log), 12):
        torn = bytearray(log)
        if damage == "cut":
            del torn[place:]
        elif damage == "zeroed":
            torn[place : place + SECTOR] = bytes(len(torn[place : place + SECTOR]))
        else:
            torn[place] ^= 1 << int(rng.integers(8))
        for end in ("", "-wal", "-shm"):
            (tmp_path / f"runs.db{end}").unlink(missing_ok=True)
        shutil.copy(folder / "runs.db", tmp_path / "runs.db")
        (tmp_path / "runs.db-wal").write_bytes(torn)
        try:
            with Store(tmp_path / "runs.db") as store:
                kept.append(len(store))
                session = Evaluator(store=store).open(models.problem(), None)
                for part in x.reshape(12, 64, -1):
                    session.evaluate(part)
                np.testing.assert_array_equal(session.evaluate(x), right)
        except StoreError:
            kept.append(0)
    # a commit is there as a whole or not at all, and what was before the damage is there
    assert all(count % 64 == 0 for count in kept)
    assert len(set(kept)) > 3


def test_commits_wait_for_the_disk(tmp_path: Path) -> None:
    with Store(tmp_path / "runs.db") as store:
        pragma = store._connection.execute
        assert pragma("PRAGMA journal_mode").fetchone() == ("wal",)
        assert pragma("PRAGMA synchronous").fetchone() == (2,)  # FULL: every commit is synced
