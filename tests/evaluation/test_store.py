"""The store: what it gives back, what it refuses, and what survives."""

import functools
import os
import signal
import sqlite3
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

import uqfold
from tests.evaluation import models
from uqfold.evaluation import Evaluator, FailedRunError, Store, StoreError
from uqfold.evaluation.batch import HAND_OVER_SECONDS
from uqfold.evaluation.calling import MOST_COMPARED
from uqfold.evaluation.identity import model_identity
from uqfold.evaluation.row_model import RowModel
from uqfold.evaluation.shelf import MOST_WAITING, Shelf
from uqfold.evaluation.store import entry_key
from uqfold.methods import FFNIPearson, MonteCarlo
from uqfold.typing import FloatArray, Model

ASKED = uqfold.criteria([1.0, 2.0])
IDENTITY = bytes(range(32))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "runs.db"


def answer(model: Model, store: Path | None, systems: int = 3000, **more: object) -> object:
    evaluator = Evaluator(store=store, **more)  # type: ignore[arg-type]
    return MonteCarlo(systems=systems).estimate(
        models.problem(model), ASKED, rng=4, evaluator=evaluator
    )


def without_seconds(result: object) -> list[dict[str, object]]:
    rows = result.to_records()  # type: ignore[attr-defined]
    return [{**row, "seconds": 0.0, "n_reused": 0} for row in rows]


def test_entries_come_back_bit_for_bit(path: Path) -> None:
    y = np.array([0.1, -0.0, np.inf, -np.inf, np.nan, 5e-324, 1.7976931348623157e308])
    keys = [entry_key(IDENTITY, models.rows(n)) for n in (7, 1)]
    with Store(path) as store:
        store.put([(keys[0], y), (keys[1], y[:1])])
        assert len(store) == 8
    with Store(path) as store:
        found = store.get([*keys, b"another"], [7, 1, 1])
    assert found[0] is not None
    assert found[0].tobytes() == y.tobytes()
    assert found[0].dtype == np.float64
    assert found[1] == y[0]
    assert found[2] is None
    assert sorted(one.name for one in path.parent.iterdir()) == ["runs.db"]


def test_keys_differ_with_identity_shape_and_every_bit_of_the_inputs() -> None:
    x = models.rows(6)
    other = x.copy()
    other[3, 1] = np.nextafter(other[3, 1], 9.0)
    keys = {
        entry_key(IDENTITY, x),
        entry_key(IDENTITY[::-1], x),
        entry_key(IDENTITY, other),
        entry_key(IDENTITY, x.reshape(4, 3)),
        entry_key(IDENTITY, x[:5]),
        entry_key(IDENTITY, x[::-1]),
    }
    assert len(keys) == 6
    assert entry_key(IDENTITY, np.asfortranarray(x)) == entry_key(IDENTITY, x)


@pytest.mark.parametrize("systems", [500, 3000])
def test_second_run_reuses_all_and_gives_the_same(path: Path, systems: int) -> None:
    plain = answer(models.quadratic, None, systems)
    first = answer(models.quadratic, path, systems)
    second = answer(models.never, path, systems)
    assert without_seconds(first) == without_seconds(plain) == without_seconds(second)
    assert (first[0].n_evals, first[0].n_reused) == (2 * systems, 0)  # type: ignore[index]
    assert (second[0].n_evals, second[0].n_reused) == (2 * systems, 2 * systems)  # type: ignore[index]


def test_reused_runs_count_against_the_budget(path: Path) -> None:
    problem = models.problem()
    evaluator = Evaluator(store=path)
    for expected in (0, 100):
        row = MonteCarlo(systems=500).estimate(
            problem, ASKED, max_evals=100, rng=4, evaluator=evaluator
        )[0]
        assert (row.n_evals, row.n_reused, row.status) == (100, expected, "doubtful")


def test_points_of_a_small_design_serve_another_method(path: Path) -> None:
    model = models.Counting()
    problem, evaluator = models.problem(model), Evaluator(store=path)
    narrow = FFNIPearson(nodes_shared=3, nodes_individual=3, check=False)
    wide = replace(narrow, nodes_individual=5)
    assert narrow.estimate(problem, ASKED, evaluator=evaluator)[0].n_reused == 0
    row = wide.estimate(problem, ASKED, evaluator=evaluator)[0]
    # rules of odd order share the middle node
    assert (row.n_evals, row.n_reused, model.rows) == (15, 3, 9 + 12)
    assert wide.estimate(problem, ASKED).pf.tolist() == [
        one.pf for one in wide.estimate(problem, ASKED, evaluator=evaluator)
    ]


def test_blocks_are_found_whatever_the_batches(path: Path) -> None:
    answer(models.quadratic, path, batch_rows=4096)
    for batch_rows in (64, 640):
        row = answer(models.never, path, batch_rows=batch_rows)[0]  # type: ignore[index]
        assert row.n_reused == row.n_evals


SEEN: list[int] = []


def mended(x: FloatArray) -> FloatArray:
    SEEN.append(len(x))
    return models.quadratic(x)


def test_failed_runs_are_made_again(path: Path) -> None:
    x = models.rows(3000)
    bad = x[:, 1] > models.FATAL
    problem = models.problem(models.returning_nan)
    for small in (x[:500], x):
        failures = bad[: len(small)].sum()
        for reused in (0, len(small) - failures):
            session = Evaluator(store=path.with_suffix(f".{len(small)}")).open(problem, None)
            session.evaluate(small)
            assert (session.n_reused, session.n_failed) == (reused, failures)
        SEEN.clear()
        session = Evaluator(store=path.with_suffix(f".{len(small)}")).open(
            models.problem(mended), None
        )
        np.testing.assert_array_equal(session.evaluate(small), models.quadratic(small))
        assert SEEN[0] == failures
        assert sum(SEEN) <= failures + MOST_COMPARED


def test_policies_are_applied_to_what_comes_from_the_store(path: Path) -> None:
    x = models.rows(500)
    with pytest.raises(FailedRunError):
        Evaluator("raise", store=path).open(models.problem(models.raising), None).evaluate(x)
    session = Evaluator("count-as-failure", store=path).open(models.problem(models.raising), None)
    assert np.isposinf(session.evaluate(x)).sum() == (x[:, 1] > models.FATAL).sum()
    # what was good is kept although the run was ended
    assert session.n_reused > 0


def test_runs_of_a_cheap_model_do_not_gather_in_memory(path: Path) -> None:
    with Store(path) as store:
        shelf = Shelf(store, IDENTITY, row_by_row=True)
        x = models.rows(MOST_WAITING)
        y, numbers = models.quadratic(x), np.arange(MOST_WAITING)
        shelf.keep(x, y, numbers[:-1], 0.0)
        assert len(store) == 0
        shelf.keep(x, y, numbers[-1:], 0.0)
        assert len(store) == MOST_WAITING


def test_without_a_version_nothing_is_stored_and_that_is_said(path: Path) -> None:
    with pytest.warns(UserWarning, match="does not state the version"):
        session = Evaluator(store=path).open(models.problem(version=None), None)
    session.evaluate(models.rows(10))
    assert len(Store(path)) == 0


@dataclass(frozen=True)
class Scaled:
    factor: float

    def __call__(self, x: FloatArray) -> FloatArray:
        return self.factor * models.quadratic(x)

    def method(self, x: FloatArray) -> FloatArray:
        return self(x)


def scaled(factor: float, x: FloatArray) -> FloatArray:
    return factor * models.quadratic(x)


def test_identity_covers_name_version_inputs_and_parameters() -> None:
    base = models.problem()
    # name and version say which function it is
    assert model_identity(base) == model_identity(models.problem(models.never))
    assert model_identity(models.problem(version=None)) is None
    different = [
        base,
        models.problem(version="2"),
        uqfold.Problem(
            models.quadratic,
            individual=dict(zip("ab", base.inputs.marginals, strict=True)),
            name="other",
            version="1",
        ),
        uqfold.Problem(
            models.quadratic,
            individual=dict(zip("ba", base.inputs.marginals, strict=True)),
            name="quadratic",
            version="1",
        ),
        *(models.problem(Scaled(factor)) for factor in (2.0, 2.0000000000000004)),
        *(models.problem(Scaled(factor).method) for factor in (3.0, 4.0)),
        *(models.problem(functools.partial(scaled, factor)) for factor in (2.0, 3.0)),
    ]
    assert len({model_identity(one) for one in different}) == len(different)
    assert model_identity(models.problem(Scaled(2.0))) == model_identity(
        models.problem(Scaled(2.0))
    )


def test_built_in_problems_state_their_version() -> None:
    from uqfold.mechanism import WingParameters

    wing = uqfold.problems.folding_wing()
    stiffer = uqfold.problems.folding_wing(WingParameters(C_f=0.2))
    assert wing.version == uqfold.problems.folding_wing().version
    assert wing.version != stiffer.version
    for one in (wing, uqfold.problems.series(), uqfold.problems.four_bar()):
        assert model_identity(one) is not None


def test_a_foreign_file_is_refused_and_left_alone(path: Path) -> None:
    path.write_text("x, y\n1.0, 2.0\n" * 100)
    before = path.read_bytes()
    with pytest.raises(StoreError, match="not a store of uqfold"):
        Store(path)
    assert path.read_bytes() == before
    other = path.with_name("other.db")
    with sqlite3.connect(other) as connection:
        connection.execute("CREATE TABLE runs (x REAL)")
    connection.close()
    before = other.read_bytes()
    with pytest.raises(StoreError, match="is a database, but not a store"):
        Store(other)
    assert other.read_bytes() == before


def test_another_format_is_refused(path: Path) -> None:
    Store(path).close()
    with sqlite3.connect(path) as connection:
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    with pytest.raises(StoreError, match="format 99"):
        Store(path)


def test_a_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="cannot be opened or made: check the folder"):
        Store(tmp_path / "missing" / "runs.db")


def test_a_file_that_cannot_be_written_is_named(path: Path) -> None:
    if os.geteuid() == 0:
        pytest.skip("the superuser may write anything")
    Store(path).close()
    path.chmod(stat.S_IRUSR)
    with pytest.raises(StoreError, match="read-only"):
        Store(path).put([(b"k", np.ones(1))])


def test_damage_is_an_error_or_costs_runs_but_never_gives_a_wrong_number(path: Path) -> None:
    x = models.rows(3000)
    right = models.quadratic(x)
    Evaluator(store=path).open(models.problem(), None).evaluate(x)
    with Store(path) as store:
        assert len(store) == 3000
    content = path.read_bytes()
    rng = np.random.default_rng(11)
    refused = 0
    for place in rng.integers(0, len(content), 300):
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        try:
            with Store(path) as store:
                session = Evaluator(store=store).open(models.problem(), None)
                np.testing.assert_array_equal(session.evaluate(x), right)
        except StoreError:
            refused += 1
    # most of the file is responses and keys
    assert refused > 100
    for length in rng.integers(1, len(content), 20):
        path.write_bytes(content[:length])
        with pytest.raises(StoreError), Store(path) as store:
            Evaluator(store=store).open(models.problem(), None).evaluate(x)


def test_damage_that_sqlite_cannot_put_into_words_is_an_error_too(path: Path) -> None:
    """Its message would quote a name in the file that is no text any more."""
    Store(path).close()
    path.write_bytes(path.read_bytes().replace(b"UNIQUE", b"\xd3NIQUE"))
    with pytest.raises(StoreError, match="is damaged"):
        Store(path)


def test_store_errors_are_no_status_of_a_method(path: Path) -> None:
    evaluator = Evaluator(store=path)
    assert isinstance(evaluator.store, Store)
    evaluator.store.close()
    with pytest.raises(StoreError, match="closed"):
        MonteCarlo(systems=10).estimate(models.problem(), ASKED, rng=1, evaluator=evaluator)


def test_a_full_disk_is_named_and_what_was_committed_stays(path: Path) -> None:
    store = Store(path)
    keys = [entry_key(IDENTITY, models.rows(1, seed=i)) for i in range(200)]
    store.put([(key, np.ones(64)) for key in keys[:20]])
    pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
    store._connection.execute(f"PRAGMA max_page_count = {pages + 2}")
    with pytest.raises(StoreError, match="disk is full"):
        store.put([(key, np.ones(64)) for key in keys[20:]])
    store.close()
    assert len(Store(path)) == 20 * 64


def test_a_fork_cannot_use_the_store_of_its_parent(path: Path) -> None:
    code = (
        "import os, sys\n"
        "from uqfold.evaluation import Store, StoreError\n"
        f"store = Store({str(path)!r})\n"
        "if os.fork() == 0:\n"
        "    try:\n"
        "        len(store)\n"
        "    except StoreError as error:\n"
        "        print(error, flush=True)\n"
        "    os._exit(0)\n"
        "os.wait()\n"
        "print(len(store))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert "opened by another process" in done.stdout
    assert done.stdout.endswith("\n0\n")


def test_two_processes_share_a_store(path: Path) -> None:
    code = (
        "import sys, numpy as np\n"
        "from uqfold.evaluation import Store\n"
        "from uqfold.evaluation.store import entry_key\n"
        f"store = Store({str(path)!r})\n"
        "first = int(sys.argv[1])\n"
        "for i in range(first, first + 200):\n"
        "    store.put([(entry_key(bytes(32), np.full((1, 2), i)), np.full(1, float(i)))])\n"
    )
    writers = [
        subprocess.Popen([sys.executable, "-c", code, str(first)]) for first in (0, 100, 200)
    ]
    assert [writer.wait(timeout=120) for writer in writers] == [0, 0, 0]
    with Store(path) as store:
        keys = [entry_key(bytes(32), np.full((1, 2), i)) for i in range(400)]
        found = store.get(keys, [1] * 400)
    assert [None if y is None else y[0] for y in found] == list(range(400))


def test_a_killed_transaction_leaves_no_trace(path: Path) -> None:
    code = (
        "import os, signal, numpy as np\n"
        "from uqfold.evaluation import Store\n"
        f"store = Store({str(path)!r})\n"
        "store.put([(b'first', np.ones(64))])\n"
        "connection = store._connection\n"
        "connection.execute('BEGIN IMMEDIATE')\n"
        "connection.execute('PRAGMA cache_size = 5')\n"
        "rest = ('<f8', 64, bytes(512), bytes(8))\n"
        "insert = 'INSERT INTO responses VALUES (?, ?, ?, ?, ?)'\n"
        "connection.executemany(insert, ((b'%d' % i, *rest) for i in range(5000)))\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], check=False, timeout=60)
    assert done.returncode == -signal.SIGKILL
    with Store(path) as store:
        assert len(store) == 64


@pytest.mark.parametrize("given", [42, True, b"runs.db", [], Store, 1.5])
def test_what_is_no_store_is_refused(given: object) -> None:
    with pytest.raises(TypeError, match=r"store = .*give a Store or the path of its file, or None"):
        Evaluator(store=given)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="path = "):
        Store(given)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "given", [":memory:", " :memory: ", "", "  ", "file::memory:", "file:runs?mode=memory", "a\0b"]
)
def test_a_store_that_would_keep_nothing_is_refused(
    given: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for make in (Store, lambda path: Evaluator(store=path), lambda path: Store(Path(path))):
        with pytest.raises((ValueError, StoreError)):
            make(given)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"batch_rows": 1.5}, ValueError),
        ({"batch_rows": True}, TypeError),
        ({"batch_rows": "64"}, TypeError),
        ({"progress": 3}, TypeError),
        ({"watch": "bar"}, TypeError),
        ({"max_seconds": "60"}, TypeError),
        ({"seconds_per_run": float("nan")}, ValueError),
        ({"failed_runs": 1}, TypeError),
    ],
)
def test_settings_of_the_evaluator_are_checked(
    settings: dict[str, object], error: type[Exception]
) -> None:
    (name,) = settings
    with pytest.raises(error, match=f"{name} = "):
        Evaluator(**settings)  # type: ignore[arg-type]


def test_numpy_scalars_are_as_good_as_numbers() -> None:
    evaluator = Evaluator(batch_rows=np.int64(7), max_seconds=np.float32(2))  # type: ignore[arg-type]
    assert (evaluator.batch_rows, evaluator.max_seconds) == (7, 2.0)
    assert type(evaluator.batch_rows) is int


class Stopped(BaseException):
    """What the handler of a signal raises."""


@pytest.mark.parametrize("raised", [KeyboardInterrupt, Stopped])
@pytest.mark.parametrize("batch_rows", [None, 1024])
def test_each_finished_sample_is_stored_when_the_program_is_stopped(
    raised: type[BaseException], batch_rows: int | None, path: Path
) -> None:
    """With `batch_rows`, as the command line has it, Ctrl-C lost all samples of a batch."""
    made = 0

    def stop(number: int, frame: object) -> None:
        raise raised

    def sample(x: FloatArray) -> float:
        nonlocal made
        if made == 30:
            signal.raise_signal(signal.SIGINT)
        time.sleep(0.01)
        made += 1
        return float(x[0] - x[1])

    before = signal.signal(signal.SIGINT, stop)
    try:
        with Store(path) as store:
            evaluator = Evaluator(store=store, batch_rows=batch_rows)
            session = evaluator.open(models.problem(Sampled(sample)), None)
            with pytest.raises(raised):
                session.evaluate(models.rows(400))
            # finished work worth less than 50 ms may be lost
            assert 30 - HAND_OVER_SECONDS / 0.01 <= len(store) <= 30
    finally:
        signal.signal(signal.SIGINT, before)


@dataclass(frozen=True)
class Sampled(RowModel):
    """A function of one sample that is no part of what the model is."""

    function: Callable[[FloatArray], float] = field(compare=False)
    parallel: int = 1

    def run(self, x: FloatArray) -> float:
        return self.function(x)


@pytest.mark.parametrize("workers", [0, 2])
def test_samples_of_one_batch_are_stored_while_others_wait(workers: int, path: Path) -> None:
    """They were stored when the whole batch was through; each is run once, wherever that is."""
    kept, seen = [], []

    def sample(x: FloatArray) -> float:
        time.sleep(0.03)
        with Store(path) as other:
            kept.append(len(other))
        seen.append(float(x[0]))
        return np.nan if len(seen) == 7 else float(x[0])

    x = models.rows(24)
    with ThreadPoolExecutor(max(1, workers)) as pool:
        evaluator = Evaluator(store=path, batch_rows=12, executor=pool if workers else None)
        session = evaluator.open(models.problem(Sampled(sample)), None)
        y = session.evaluate(x)
    assert max(kept[:10]) > 0
    assert (session.n_evals, session.n_failed) == (24, 1)
    assert sorted(seen) == sorted(x[:, 0])
    good = ~np.isnan(y)
    np.testing.assert_array_equal(y[good], x[good, 0])


def test_threads_of_a_model_of_samples_share_a_batch() -> None:
    """With `batch_rows`, as the command line has it, one thread ran all of them."""
    both = threading.Barrier(2, timeout=60.0)

    def sample(x: FloatArray) -> float:
        both.wait()
        return float(x[0])

    session = Evaluator(batch_rows=1024).session(Sampled(sample, parallel=2), 2, None)
    x = models.rows(20)
    np.testing.assert_array_equal(session.evaluate(x), x[:, 0])


@pytest.mark.parametrize(
    "change",
    [
        "DROP TABLE responses",
        "ALTER TABLE responses DROP COLUMN dtype",
        "CREATE TRIGGER t BEFORE INSERT ON responses BEGIN SELECT RAISE(ABORT, 'no'); END",
    ],
)
def test_a_store_that_another_program_has_changed_is_told_with_a_remedy(
    path: Path, change: str
) -> None:
    with Store(path) as store:
        with sqlite3.connect(path) as connection:
            connection.execute(change)
        connection.close()
        with pytest.raises(StoreError, match="put back a copy of the file, or give another path"):
            store.put([(b"k", np.ones(1))])
    if change != "DROP TABLE responses":
        return
    with pytest.raises(StoreError, match="put back a copy of the file, or give another path"):
        Store(path)
