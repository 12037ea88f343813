"""Ask and tell: the answer of `estimate`, whoever runs the model, also after an interruption."""

import gc
import json
import math
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from uqfold.evaluation import Evaluator, FailedRunError
from uqfold.methods import Estimate, ReliabilityResult, Solution, Task, available
from uqfold.methods.ask_tell_session import AskTellSession
from uqfold.methods.session_file import SCHEMA, WITHOUT_DIGEST, SessionFileError
from uqfold.methods.steps import SequentialMethod, Steps
from uqfold.problems import Problem
from uqfold.problems.base import Unit
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing import LinearNormalSystem
from uqfold.testing.conduct import same_numbers
from uqfold.typing import FloatArray

SYSTEM = LinearNormalSystem()
SYSTEM_INPUTS = {"inputs": SYSTEM.problem().inputs.distribution, "shared": ["V"]}
ASKED = criteria([10.0, 11.0], tau=[None, 2.0], missions=[1, Binomial(3, 0.6)])


@dataclass(frozen=True)
class Walk(SequentialMethod):
    """Each batch depends on the responses before it, so that no step may be lost or changed."""

    name: ClassVar[str] = "walk"
    bounds_failed_runs: ClassVar[bool] = True
    batches: int = 4
    rows: int = 3

    @property
    def stochastic(self) -> bool:
        return True

    def _steps(self, task: Task) -> Steps:
        rng = task.generator()
        centre, seen = np.zeros(3), []
        for _ in range(self.batches):
            y = yield task.problem.inputs.from_standard_normal(
                centre + rng.standard_normal((self.rows, 3))
            )
            centre = centre + 0.1 * np.nan_to_num(np.resize(y, 3), posinf=1.0)
            seen.append(y)
        y = np.concatenate(seen)
        late = float(np.mean(~(y <= 11.0)))
        answer = Estimate(
            late, pf_low=float(np.mean(y > 11.0)), pf_high=late, message=f"{np.nansum(y)!r}"
        )
        return Solution([answer] * len(task.criteria), details="walked")


@dataclass(frozen=True)
class Breaks(SequentialMethod):
    name: ClassVar[str] = "breaks"

    def _steps(self, task: Task) -> Steps:
        yield np.zeros((2, 3))
        raise ArithmeticError("no root")


def outside(model: object = None, **options: object) -> Problem:
    """A problem whose runs are made elsewhere; without a model none can be made here."""
    inputs = SYSTEM.problem().inputs.distribution
    return Problem(model, inputs=inputs, shared=["V"], name="outside", **options)  # type: ignore[arg-type]


def finished(session: AskTellSession, model: object = SYSTEM.response) -> ReliabilityResult:
    while not session.done:
        x = session.ask()
        session.tell(x, model(x))  # type: ignore[operator]
    return session.result()


def test_told_responses_give_the_answer_of_estimate() -> None:
    result = finished(Walk().start(outside(), ASKED, rng=5, max_evals=12))
    expected = Walk().estimate(outside(SYSTEM.response), ASKED, rng=5, max_evals=12)
    assert same_numbers(result, expected)
    assert (result.n_evals, result.seed, result.details) == (12, 5, "walked")
    # and the comparison can fail
    assert not same_numbers(result, Walk().estimate(outside(SYSTEM.response), ASKED, rng=6))


def test_a_problem_without_a_model_is_for_sessions_only() -> None:
    with pytest.raises(ValueError, match=r"the problem has no model: let a session ask"):
        Walk().estimate(outside(), ASKED)
    assert "outside: response, 1 unit" in str(outside())


def with_failures(x: FloatArray) -> FloatArray:
    y = SYSTEM.response(x)
    y[x[:, 2] > 0.3] = np.nan
    y[x[:, 1] > 1.2] = np.inf
    return y


@pytest.mark.parametrize("policy", ["bound", "count-as-failure"])
def test_failed_runs_are_counted_as_in_estimate(policy: str) -> None:
    evaluator = Evaluator(policy)  # type: ignore[arg-type]
    session = Walk().start(outside(), ASKED, rng=5, evaluator=evaluator)
    result = finished(session, with_failures)
    expected = Walk().estimate(outside(with_failures), ASKED, rng=5, evaluator=evaluator)
    assert same_numbers(result, expected)
    assert result.n_failed > 0


def test_policy_raise_raises_and_stays_raised() -> None:
    session = Walk().start(outside(), ASKED, rng=5, evaluator=Evaluator("raise"))
    x = session.ask()
    with pytest.raises(FailedRunError, match="NaN"):
        session.tell(x, np.full(len(x), np.nan))
    assert session.done
    with pytest.raises(FailedRunError, match="NaN"):
        session.result()


def test_budget_ends_the_session_as_it_ends_estimate() -> None:
    result = finished(Walk().start(outside(), ASKED, rng=5, max_evals=7))
    expected = Walk().estimate(outside(SYSTEM.response), ASKED, rng=5, max_evals=7)
    assert same_numbers(result, expected)
    assert "out of budget" in result[0].message
    assert result.n_evals == 6


def test_exceptions_of_the_method_become_a_status() -> None:
    result = finished(Breaks().start(outside(), ASKED))
    assert result[0].message == "ArithmeticError: no root"
    assert same_numbers(
        finished(Breaks().start(outside(), ASKED, rng=1)),
        Breaks().estimate(outside(SYSTEM.response), ASKED, rng=1),
    )


def test_what_is_unsupported_is_done_at_once() -> None:
    session = Walk().start(outside(units=[Unit(offset=0.1), Unit()]), ASKED)
    assert session.done
    assert {row.status for row in session.result()} == {"unsupported"}


def test_responses_may_come_in_parts_and_in_any_order() -> None:
    session = Walk(rows=5).start(outside(), ASKED, rng=5)
    while not session.done:
        x = session.ask()
        before = session.n_evals
        session.tell(x[[3, 1]], SYSTEM.response(x[[3, 1]]))
        assert session.n_evals == before + 2
        np.testing.assert_array_equal(session.ask(), x[[0, 2, 4]])
        rest = session.ask()[::-1]
        session.tell(rest, SYSTEM.response(rest))
    expected = Walk(rows=5).estimate(outside(SYSTEM.response), ASKED, rng=5)
    assert same_numbers(session.result(), expected)


def test_equal_rows_each_want_their_response() -> None:
    session = Breaks().start(outside(), ASKED)
    x = session.ask()
    session.tell(x[:1], [1.0])
    assert len(session.ask()) == 1
    with pytest.raises(ValueError, match="was not asked for"):
        session.tell(x, [1.0, 2.0])
    assert len(session.ask()) == 1
    session.tell(x[:1], [2.0])
    assert session.done


@pytest.mark.parametrize(
    ("x", "y", "match"),
    [
        (np.zeros((3, 2)), np.zeros(3), r"^x = .*: give real numbers of shape \(n, 3\)"),
        (np.zeros((3, 3)), np.zeros(2), "^y = .*: give one response for each of 3 rows"),
        (np.zeros((1, 3)), np.zeros(1), "was not asked for"),
    ],
)
def test_responses_to_other_rows_are_refused(x: FloatArray, y: FloatArray, match: str) -> None:
    session = Walk().start(outside(), ASKED, rng=5)
    with pytest.raises(ValueError, match=match):
        session.tell(x, y)
    assert same_numbers(finished(session), Walk().estimate(outside(SYSTEM.response), ASKED, rng=5))


@pytest.mark.parametrize(
    ("y", "named"),
    [
        (np.array([True, False, True]), "dtype bool"),
        ([True, 1.0, 2.0], "a bool"),
        (np.array([1, 2, 3], dtype="M8[s]"), "datetime64"),
        (np.array([1, 2, 3], dtype="m8[s]"), "timedelta64"),
        (np.zeros(3, dtype=[("y", float)]), "dtype"),
        (["1_5", "2", "3"], "dtype <U3"),
        (np.array([1.0 + 2.0j, 1.0, 2.0]), "complex"),
        ([1.0 + 2.0j, 1.0, 2.0], "complex"),
        ({"y": 1.0}, "dict"),
    ],
)
def test_told_responses_that_are_no_numbers_are_refused(y: object, named: str) -> None:
    session = Walk().start(outside(), ASKED, rng=5)
    x = session.ask()
    with pytest.raises(TypeError, match=named):
        session.tell(x, y)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="x = "):
        session.tell(x > 0.0, [1.0, 2.0, 3.0])
    assert same_numbers(finished(session), Walk().estimate(outside(SYSTEM.response), ASKED, rng=5))


@pytest.mark.parametrize(
    "missing", [np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0]), [1.0, None, 3.0], [1.0, np.nan, 3.0]]
)
def test_a_masked_entry_is_told_as_a_failed_run(missing: object) -> None:
    session = Walk(batches=1).start(outside(), ASKED, rng=5)
    session.tell(session.ask(), missing)  # type: ignore[arg-type]
    assert session.result().n_failed == 1
    column = Walk(batches=1).start(outside(), ASKED, rng=5)
    column.tell(column.ask(), np.array([[1.0], [np.nan], [3.0]]))
    assert same_numbers(column.result(), session.result())


def test_order_of_calls_is_held() -> None:
    session = Walk(batches=1).start(outside(), ASKED, rng=5)
    with pytest.raises(RuntimeError, match="3 responses are still wanted"):
        session.result()
    x = session.ask()
    x[:] = 7.0
    assert not np.any(session.ask() == 7.0), "the caller's array must not reach the session"
    finished(session)
    with pytest.raises(RuntimeError, match="call result"):
        session.ask()
    with pytest.raises(RuntimeError, match="takes no more"):
        session.tell(x, np.zeros(3))


@pytest.mark.parametrize("told", [0, 2, 3, 7, 12])
def test_resumed_session_goes_on_exactly(told: int, tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    session = Walk().start(outside(), ASKED, rng=5, max_evals=50)
    for _ in range(told):
        x = session.ask()[:1]
        session.tell(x, with_failures(x))
    session.save(path)
    resumed = Walk().resume(path, outside(), ASKED)
    assert (resumed.n_evals, resumed.seed, resumed.done) == (told, 5, session.done)
    if not session.done:
        np.testing.assert_array_equal(resumed.ask(), session.ask())
    expected = Walk().estimate(outside(with_failures), ASKED, rng=5, max_evals=50)
    assert same_numbers(finished(resumed, with_failures), expected)
    assert [entry.name for entry in tmp_path.iterdir()] == ["walk.npz"]


@pytest.mark.parametrize(
    ("word", "change"),
    [
        ("method", {"method": Walk(batches=5)}),
        ("version", {"problem": outside(version="2")}),
        ("seed", {"rng": 6}),
        ("max_evals", {"max_evals": 49}),
        ("criteria", {"criteria": criteria([10.0, 11.5])}),
        ("failed_runs", {"evaluator": Evaluator("count-as-failure")}),
        ("units", {"problem": outside(units=2)}),
    ],
)
def test_another_run_is_refused(word: str, change: dict[str, object], tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    Walk().start(outside(), ASKED, rng=5, max_evals=50).save(path)
    arguments = {"method": Walk(), "problem": outside(), "criteria": ASKED, **change}
    method, problem, asked = (arguments.pop(key) for key in ("method", "problem", "criteria"))
    with pytest.raises(SessionFileError, match=f"belongs to another run: its {word} is"):
        method.resume(path, problem, asked, **arguments)  # type: ignore[attr-defined]


def test_other_inputs_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    Walk().start(outside(), ASKED, rng=5).save(path)
    inputs = SYSTEM.problem().inputs.distribution
    import openturns as ot

    wider = ot.JointDistribution(
        [ot.Normal(0.0, 1.0 + 1e-6), *(inputs.getMarginal(i) for i in (1, 2))]
    )
    wider.setDescription(inputs.getDescription())
    problem = Problem(None, inputs=wider, shared=["V"], name="outside")
    with pytest.raises(SessionFileError, match="its distribution is"):
        Walk().resume(path, problem, ASKED)


def test_rows_of_another_stream_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    session = Walk().start(outside(), ASKED, rng=5)
    x = session.ask()
    session.tell(x, SYSTEM.response(x))
    session.save(path)
    with np.load(path) as archive:
        arrays = dict(archive)
    arrays["x"] = arrays["x"] + 1e-3
    # as it comes with a version of uqfold that kept no digest
    del arrays["digest"]
    header = json.loads(str(arrays["header"])) | {"schema": WITHOUT_DIGEST}
    np.savez(path, **arrays | {"header": np.array(json.dumps(header))})
    with pytest.raises(SessionFileError, match="asks for other rows"):
        Walk().resume(path, outside(), ASKED)


def test_damaged_and_foreign_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    session = Walk().start(outside(), ASKED, rng=5)
    x = session.ask()
    session.tell(x, SYSTEM.response(x))
    session.save(path)
    whole = path.read_bytes()
    with np.load(path) as archive:
        head = dict(archive)
    for damage in (
        b"",
        b"not a session",
        whole[: len(whole) // 2],
        whole[:300] + b"\0" * 40 + whole[340:],
    ):
        path.write_bytes(damage)
        with pytest.raises(SessionFileError, match="damaged"):
            Walk().resume(path, outside(), ASKED)
    np.savez(path, **{**head, "y": head["y"][:-1]})
    with pytest.raises(SessionFileError, match="do not fit together"):
        Walk().resume(path, outside(), ASKED)
    np.savez(path, **{**head, "header": np.array(json.dumps({"schema": "other/1"}))})
    with pytest.raises(SessionFileError, match=SCHEMA):
        Walk().resume(path, outside(), ASKED)
    np.savez(path, **{**head, "x": np.array([{"a": 1}], dtype=object)})
    with pytest.raises(SessionFileError, match="damaged"):
        Walk().resume(path, outside(), ASKED)
    for damage in (
        '{"schema": ' + "[" * 100_000,
        json.dumps({"schema": SCHEMA, "seed": -1, "max_evals": None}),
        json.dumps({"schema": SCHEMA, "seed": 1.5, "max_evals": None}),
        json.dumps({"schema": SCHEMA, "seed": 1, "max_evals": [1]}),
        json.dumps({"schema": SCHEMA, "seed": 1}),
        '{"schema": "' + SCHEMA + '", "seed": 1' + "0" * 5000 + "}",
    ):
        np.savez(path, **{**head, "header": np.array(damage)})
        with pytest.raises(SessionFileError, match="damaged"):
            Walk().resume(path, outside(), ASKED)
    for rows in ([-3, 6], [2**62, 2**62, 2**62, 2**62, 3]):
        np.savez(path, **{**head, "rows": np.array(rows)})
        with pytest.raises(SessionFileError, match="do not fit together"):
            Walk().resume(path, outside(), ASKED)
    # the former schema has no digest
    changed = json.loads(str(head["header"])) | {"seed": 10**400, "schema": WITHOUT_DIGEST}
    del head["digest"]
    np.savez(path, **{**head, "header": np.array(json.dumps(changed))})
    with pytest.raises(SessionFileError, match="its seed is 1000"):
        Walk().resume(path, outside(), ASKED, rng=5)
    with pytest.raises(FileNotFoundError):
        Walk().resume(tmp_path / "none.npz", outside(), ASKED)


def test_another_response_in_a_file_is_damage_though_its_archive_is_sound(tmp_path: Path) -> None:
    """What is read back is checked by digest."""
    path = tmp_path / "walk.npz"
    told(Walk().start(outside(), ASKED, rng=5), [0, 1]).save(path)
    with np.load(path) as archive:
        whole = dict(archive)
    Walk().resume(path, outside(), ASKED)
    header = json.loads(str(whole["header"]))
    changes = [
        {"y": np.where([True, False, False], 9.0, whole["y"])},
        {"told": np.ones(3, dtype=np.bool_)},
        {"digest": np.array("0" * 64)},
        {"header": np.array(json.dumps({**header, "max_evals": 99}))},
    ]
    for change in changes:
        np.savez(path, **{**whole, **change})
        with pytest.raises(SessionFileError, match="does not have the digest"):
            Walk().resume(path, outside(), ASKED)
    del whole["digest"]
    np.savez(path, **whole)
    with pytest.raises(SessionFileError, match="does not have the digest"):
        Walk().resume(path, outside(), ASKED)
    # files of the former schema go on
    np.savez(path, **whole | {"header": np.array(json.dumps(header | {"schema": WITHOUT_DIGEST}))})
    resumed = Walk().resume(path, outside(), ASKED)
    assert same_numbers(finished(resumed), Walk().estimate(outside(SYSTEM.response), ASKED, rng=5))


def told(session: AskTellSession, rows: list[int], shift: float = 0.0) -> AskTellSession:
    x = session.ask()[rows]
    session.tell(x, SYSTEM.response(x) + shift)
    return session


def test_no_save_loses_the_responses_of_another_process(tmp_path: Path) -> None:
    """Two processes saving one session file: the second is told, and the file is left as it is."""
    path = tmp_path / "walk.npz"
    first, second, other = (Walk().start(outside(), ASKED, rng=seed) for seed in (5, 5, 6))
    told(first, [0]).save(path)
    # a session that has all that the file has goes on with it
    told(second, [1, 0]).save(path)
    kept = path.read_bytes()
    for session, message in (
        (told(first, [1]), "holds responses that this session has not"),
        (
            told(Walk().start(outside(), ASKED, rng=5), [0, 1], 1.0),
            "holds responses that this session",
        ),
        (other, "belongs to another run: its seed is"),
    ):
        with pytest.raises(SessionFileError, match=f"walk.npz {message}"):
            session.save(path)
        assert path.read_bytes() == kept
    (tmp_path / "thesis.txt").write_text("words")
    with pytest.raises(SessionFileError, match="not a session file"):
        first.save(tmp_path / "thesis.txt")
    assert (tmp_path / "thesis.txt").read_text() == "words"


@pytest.mark.thorough
def test_processes_that_save_at_once_leave_one_whole_session(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    programs = [
        subprocess.Popen(
            [sys.executable, "-m", "tests.methods.saving_program", str(path), str(seed)],
            stdout=subprocess.PIPE,
            text=True,
            cwd=Path(__file__).parents[2],
        )
        for seed in (5, 6)
    ]
    said = [program.communicate(timeout=60.0)[0] for program in programs]
    # one of the two was first, and all that it has saved is there
    winner = said.index("saved 3\n")
    assert said[1 - winner] == "refused\n"
    assert Walk().resume(path, outside(), ASKED).seed == (5, 6)[winner]
    assert Walk().resume(path, outside(), ASKED).n_evals == 3
    assert [entry.name for entry in tmp_path.iterdir()] == ["walk.npz"]


def test_the_lock_of_a_killed_process_holds_nobody_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "walk.npz"
    code = (
        "import pathlib, sys, time; from uqfold.methods.session_lock import locked\n"
        "with locked(pathlib.Path(sys.argv[1])): print('locked', flush=True); time.sleep(600)"
    )
    holder = subprocess.Popen(
        [sys.executable, "-c", code, str(path)], stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == "locked\n"
    session = Walk().start(outside(), ASKED, rng=5)
    monkeypatch.setattr("uqfold.methods.session_lock.WAIT_SECONDS", 0.1)
    with pytest.raises(SessionFileError, match=r"walk.npz cannot be saved: another process"):
        session.save(path)
    holder.kill()
    holder.communicate()
    session.save(path)
    assert Walk().resume(path, outside(), ASKED).seed == 5


def test_time_of_the_model_is_not_counted() -> None:
    session = Walk(batches=1).start(outside(), Criterion(10.0), rng=5)
    result = finished(session)
    assert 0.0 < result.seconds < 1.0
    assert math.isfinite(result[0].pf)


OF_SURFACES = {"kriging", "pce", "active-kriging", "auto"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.thorough if name in OF_SURFACES else [])
        for name in available()
    ],
)
def test_every_method_asks_for_its_runs(name: str, tmp_path: Path) -> None:
    """Through an interruption too."""
    own = Problem(SYSTEM.response, **SYSTEM_INPUTS, low_fidelity=SYSTEM.response)
    problem = Problem(None, **SYSTEM_INPUTS, low_fidelity=SYSTEM.response)
    method, limit, evaluator = available()[name](), Criterion(11.0), Evaluator(batch_rows=500)
    session = method.start(problem, limit, max_evals=1_500, rng=3, evaluator=evaluator)
    first = session.ask()
    assert len(first) <= 500
    session.tell(first, SYSTEM.response(first))
    session.save(tmp_path / "session.npz")
    resumed = method.resume(tmp_path / "session.npz", problem, limit)
    expected = method.estimate(own, limit, max_evals=1_500, rng=3)
    assert math.isfinite(expected[0].pf)
    for one in (session, resumed):
        assert same_numbers(finished(one), expected)


def test_a_session_that_is_left_leaves_no_thread() -> None:
    before = threading.active_count()
    session = available()["openturns-mc"]().start(outside(), Criterion(11.0), max_evals=1_000)
    assert threading.active_count() == before + 1
    del session
    gc.collect()
    last = time.monotonic() + 10.0
    while threading.active_count() > before:
        assert time.monotonic() < last
        time.sleep(0.001)


def test_rows_may_be_asked_for_in_other_numbers_after_an_interruption(tmp_path: Path) -> None:
    path = tmp_path / "session.npz"
    method = available()["mc"]()
    arguments = {"max_evals": 600, "rng": 3}
    session = method.start(
        outside(), Criterion(11.0), evaluator=Evaluator(batch_rows=50), **arguments
    )
    for _ in range(3):
        x = session.ask()
        session.tell(x[::2], SYSTEM.response(x[::2]))
        session.tell(x[1::2], SYSTEM.response(x[1::2]))
    x = session.ask()[:7]
    session.tell(x, SYSTEM.response(x))
    session.save(path)
    resumed = method.resume(path, outside(), Criterion(11.0), evaluator=Evaluator(batch_rows=101))
    assert resumed.n_evals == 157
    expected = method.estimate(outside(SYSTEM.response), Criterion(11.0), **arguments)
    assert same_numbers(finished(resumed), expected)
