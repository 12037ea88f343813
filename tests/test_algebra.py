"""Linear algebra that decides runs on one BLAS thread; the program's setting comes back."""

import math
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
from threadpoolctl import ThreadpoolController

import uqfold
from uqfold import algebra
from uqfold.algebra import one_blas_thread, program_blas_threads
from uqfold.methods import (
    ActiveKriging,
    FFNIPearson,
    Kriging,
    MonteCarlo,
    PolynomialChaos,
    Solution,
    Task,
)
from uqfold.methods.steps import SequentialMethod
from uqfold.surrogates.gaussian_process import fit_gaussian_process
from uqfold.testing.conduct import same_numbers
from uqfold.testing.curved import CurvedSystem

LIBRARIES = ThreadpoolController().select(user_api="blas")


def setting() -> list[int]:
    return [library.get_num_threads() for library in LIBRARIES.lib_controllers]


@pytest.fixture(autouse=True)
def _three_threads() -> Iterator[None]:
    if not LIBRARIES.lib_controllers:
        pytest.skip("no BLAS library whose threads can be set")
    with LIBRARIES.limit(limits=3):
        if setting() != [3] * len(setting()):
            pytest.skip("BLAS libraries that cannot take three threads")
        yield


THREE, ONE = [3] * len(setting()), [1] * len(setting())


def test_nested_use_and_an_exception_restore_the_setting() -> None:
    def interrupted() -> None:
        with one_blas_thread():
            assert setting() == ONE
            with program_blas_threads():
                assert setting() == THREE
                with one_blas_thread():
                    assert setting() == ONE
                assert setting() == THREE
            assert setting() == ONE
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), one_blas_thread():
        interrupted()
    assert setting() == THREE


def test_setting_comes_back_when_the_last_of_several_threads_is_done() -> None:
    entered, leave = threading.Event(), threading.Event()

    def other() -> None:
        with one_blas_thread():
            entered.set()
            leave.wait(10.0)

    thread = threading.Thread(target=other)
    with one_blas_thread():
        thread.start()
        assert entered.wait(10.0)
        with program_blas_threads():
            # what the other one computes must not depend on what this one is at
            assert setting() == ONE
    assert setting() == ONE
    leave.set()
    thread.join()
    assert setting() == THREE


def test_ctrl_c_while_the_setting_is_restored_loses_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    settle, calls = algebra._STATE._settle, []

    def interrupted() -> None:
        calls.append(None)
        if len(calls) == 2:
            raise KeyboardInterrupt
        settle()

    monkeypatch.setattr(algebra._STATE, "_settle", interrupted)
    with pytest.raises(KeyboardInterrupt), one_blas_thread():
        assert setting() == ONE
    assert setting() == THREE


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_forked_child_has_the_setting_of_the_program_although_another_thread_computes() -> None:
    entered, leave = threading.Event(), threading.Event()

    def other() -> None:
        with one_blas_thread():
            entered.set()
            leave.wait(10.0)

    thread = threading.Thread(target=other)
    thread.start()
    assert entered.wait(10.0)
    child = os.fork()
    if child == 0:
        os._exit(0 if setting() == THREE else 1)
    status = os.waitpid(child, 0)[1]
    leave.set()
    thread.join()
    assert os.waitstatus_to_exitcode(status) == 0


class OfEachThread:
    """A library whose number of threads belongs to the thread that sets it."""

    threading_layer = "openmp"

    def __init__(self) -> None:
        self._local = threading.local()

    def get_num_threads(self) -> int:
        return getattr(self._local, "threads", 8)

    def set_num_threads(self, threads: int) -> None:
        self._local.threads = threads


def test_number_that_belongs_to_each_thread_is_restored_in_each(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    library, seen = OfEachThread(), list[int]()
    monkeypatch.setattr(algebra, "_libraries", lambda: (library,))

    def other() -> None:
        library.set_num_threads(4)
        with one_blas_thread():
            seen.append(library.get_num_threads())
            with program_blas_threads():
                seen.append(library.get_num_threads())
            seen.append(library.get_num_threads())
        seen.append(library.get_num_threads())

    with one_blas_thread():
        thread = threading.Thread(target=other)
        thread.start()
        thread.join()
        assert library.get_num_threads() == 1
    assert seen == [1, 4, 1, 4]
    assert library.get_num_threads() == 8


class Watching:
    """A curved system that notes the setting its model runs with."""

    def __init__(self) -> None:
        self.seen: list[list[int]] = []

    def __call__(self, x: np.ndarray) -> np.ndarray:
        self.seen.append(setting())
        return CurvedSystem().response(x)

    def problem(self) -> uqfold.Problem:
        inputs = CurvedSystem().problem().inputs.distribution
        return uqfold.Problem(
            self, shared=inputs.getMarginal([0]), individual=inputs.getMarginal([1, 2]), units=1
        )


@pytest.mark.parametrize(
    "method", [MonteCarlo(systems=300), FFNIPearson(), PolynomialChaos(runs=20)]
)
def test_model_runs_with_the_setting_of_the_program(method: uqfold.ReliabilityMethod) -> None:
    model = Watching()
    method.estimate(model.problem(), uqfold.criteria(12.5), rng=1)
    assert model.seen
    assert all(seen == THREE for seen in model.seen)
    assert setting() == THREE


def test_four_threads_comparing_with_kriging_leave_the_setting_of_the_program(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They fit at once; the first to begin is the first to end, and one of them fails.

    With a setting that each thread saves and restores by itself, the last one restores what the
    others had set.
    """
    begun, over = ([threading.Event() for _ in range(4)] for _ in range(2))
    seen = list[list[int]]()
    fitting = threading.local()
    minimize = scipy.optimize.minimize

    def in_turn(*arguments: Any, **options: Any) -> Any:
        if not hasattr(fitting, "met"):
            fitting.met, number = True, int(threading.current_thread().name)
            begun[number].set()
            assert all(other.wait(60.0) for other in begun)
            # the others are within their fits until this one is done with its comparison
            assert number == 0 or over[number - 1].wait(60.0)
            seen.append(setting())
            if number == 2:
                raise KeyboardInterrupt
        return minimize(*arguments, **options)

    monkeypatch.setattr(scipy.optimize, "minimize", in_turn)
    method = Kriging(runs=12, kernel="gaussian", trend="constant")
    ended = list[str]()

    def work(number: int) -> None:
        try:
            # the setting of the program is saved by one after the other
            assert number == 0 or begun[number - 1].wait(60.0)
            frame = uqfold.compare(
                CurvedSystem(units=1).problem(), [method], uqfold.criteria(12.5), rng=number
            )
            ended.append(str(frame["label"].item()))
        except KeyboardInterrupt:
            ended.append("interrupted")
        finally:
            begun[number].set()
            over[number].set()

    threads = [threading.Thread(target=work, args=(k,), name=str(k)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert ended == ["kriging", "kriging", "interrupted", "kriging"]
    assert seen == [ONE] * 4
    assert setting() == THREE


# as many runs as make BLAS share the work
SURFACES = [
    Kriging(runs=150, kernel="gaussian", trend="constant"),
    ActiveKriging(runs=160, initial=150, kernel="gaussian"),
]


@pytest.mark.parametrize(
    "method",
    [SURFACES[0], pytest.param(SURFACES[1], marks=pytest.mark.thorough)],
    ids=lambda method: method.name,
)
def test_answer_does_not_depend_on_the_number_of_threads(method: SequentialMethod) -> None:
    # one unit: the fits and their answers, without the integration over the shared input
    problem, criteria = CurvedSystem(units=1).problem(), uqfold.criteria(13.0)
    with LIBRARIES.limit(limits=1):
        one = method.estimate(problem, criteria, rng=3)
    with LIBRARIES.limit(limits=2):
        session = method.start(problem, criteria, rng=3)
        while not session.done:
            x = session.ask()
            session.tell(x, problem.model(x))
        two = session.result()
    assert math.isfinite(one[0].pf)
    assert same_numbers(one, two)


@pytest.mark.parametrize("method", [FFNIPearson(), PolynomialChaos(runs=20)])
def test_method_computes_on_one_thread(
    method: uqfold.ReliabilityMethod, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = list[list[int]]()
    solve = type(method)._solve

    def watched(self: uqfold.ReliabilityMethod, task: Task) -> Solution:
        seen.append(setting())
        return solve(self, task)

    monkeypatch.setattr(type(method), "_solve", watched)
    method.estimate(CurvedSystem(units=1).problem(), uqfold.criteria(12.5), rng=1)
    assert seen == [ONE]


def test_a_process_is_fitted_on_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search for its hyperparameters ends elsewhere when sums are cut differently."""
    seen, minimize = list[list[int]](), scipy.optimize.minimize

    def watched(*arguments: Any, **options: Any) -> Any:
        seen.append(setting())
        return minimize(*arguments, **options)

    monkeypatch.setattr(scipy.optimize, "minimize", watched)
    u = np.linspace(-2.0, 2.0, 6)[:, None]
    fit_gaussian_process(u, np.sin(u[:, 0]))
    assert seen
    assert all(one == ONE for one in seen)
    assert setting() == THREE


PROGRAM = """
import uqfold
from uqfold.testing.curved import CurvedSystem
from tests.test_algebra import SURFACES

for method in [*SURFACES, *uqfold.methods.available().values()]:
    method = method if isinstance(method, uqfold.ReliabilityMethod) else method()
    result = method.estimate(CurvedSystem().problem(), uqfold.criteria([12.0, 14.0]), rng=3)
    for row in result:
        print(row.status, *(x.hex() for x in (row.pf, row.std_error, row.ci_low, row.ci_high)))
"""


@pytest.mark.slow
def test_answers_of_all_methods_do_not_depend_on_the_environment() -> None:
    def answers(threads: str) -> str:
        names = ("OPENBLAS", "MKL", "BLIS", "OMP")
        environment = os.environ | {f"{name}_NUM_THREADS": threads for name in names}
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True,
            check=True, cwd=Path(__file__).parents[1],
        )  # fmt: skip
        return done.stdout

    one = answers("1")
    assert one
    assert answers("2") == one
