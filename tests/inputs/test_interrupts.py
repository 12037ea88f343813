"""Ctrl-C is Python's, also while OpenTURNS runs, and always one KeyboardInterrupt."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import openturns as ot
import pytest

import uqfold
from uqfold.inputs import interrupts, product_inputs
from uqfold.inputs.engine import openturns
from uqfold.inputs.interrupts import DeferredInterrupt
from uqfold.inputs.marginal import called
from uqfold.methods import MonteCarlo, OpenTURNSFORM, OpenTURNSMonteCarlo, ReliabilityMethod

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals to oneself need POSIX")


@pytest.fixture(autouse=True)
def handler_of_python() -> Iterator[None]:
    """Whatever handler the tests were started with, Ctrl-C is a KeyboardInterrupt here."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    after = signal.signal(signal.SIGINT, before)
    assert after is signal.default_int_handler


def press(*_: Any) -> None:
    signal.raise_signal(signal.SIGINT)


@pytest.mark.skipif(sys.platform != "linux", reason="possible with ELF files only")
@pytest.mark.parametrize("in_thread", [False, True])
def test_openturns_runs_under_the_handler_of_python(in_thread: bool) -> None:
    # it had one that throws a C++ exception, in whatever thread the signal came
    handlers = [interrupts._get_c_handler(signal.SIGINT)]

    def probe(rows: Any) -> Any:
        handlers.append(interrupts._get_c_handler(signal.SIGINT))
        return rows

    function = openturns().Function(ot.PythonFunction(1, 1, func_sample=probe))

    def run() -> None:
        function(ot.Sample([[1.0]]))

    if in_thread:
        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
    else:
        run()
    handlers.append(interrupts._get_c_handler(signal.SIGINT))
    assert len(set(handlers)) == 1


def test_ctrl_c_waits_until_openturns_has_returned() -> None:
    reached = []

    def waits() -> None:
        with DeferredInterrupt():
            press()
            reached.append("the end")

    def is_let_in() -> None:
        with DeferredInterrupt() as deferred, deferred.let_in():
            press()
            reached.append("never")

    def comes_first() -> None:
        with DeferredInterrupt() as deferred:
            press()
            with deferred.let_in():
                reached.append("never")

    for case in (waits, is_let_in, comes_first):
        with pytest.raises(KeyboardInterrupt):
            case()
    assert reached == ["the end"]


def test_ctrl_c_while_openturns_looks_at_a_sample_is_not_lost() -> None:
    # OpenTURNS and NumPy take what is raised there as "no such attribute", and go on
    with pytest.raises(KeyboardInterrupt):
        called(lambda sample: press() or sample, np.zeros((3, 1)))


def test_an_interruption_that_openturns_reports_is_a_keyboard_interrupt() -> None:
    def interrupted(_: Any) -> Any:
        raise RuntimeError("Interruption in OT::Distribution::computeCDF")

    with pytest.raises(KeyboardInterrupt):
        called(interrupted, np.zeros((3, 1)))


class Pressing(ot.PythonDistribution):
    """A uniform distribution that a user wrote, in which Ctrl-C is pressed once."""

    armed = False  # of the class: OpenTURNS makes copies

    def __init__(self) -> None:
        super().__init__(1)

    def getRange(self) -> Any:
        return ot.Interval(0.0, 1.0)

    def computeCDF(self, x: Any) -> float:
        if Pressing.armed:
            Pressing.armed = False
            press()
        return min(max(x[0], 0.0), 1.0)


def test_ctrl_c_inside_a_users_own_distribution() -> None:
    inputs = product_inputs(None, {"x": ot.Distribution(Pressing())})
    u = np.zeros((5, 1))
    Pressing.armed = True
    with pytest.raises(KeyboardInterrupt):
        inputs.from_standard_normal(u)
    assert not Pressing.armed
    np.testing.assert_allclose(inputs.from_standard_normal(u), 0.5)


METHODS = [
    MonteCarlo(systems=1000),
    OpenTURNSMonteCarlo(),
    OpenTURNSFORM(algorithms=("AbdoRackwitz", "Cobyla")),
    OpenTURNSFORM(algorithms=("Cobyla", "SQP")),
]


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
@pytest.mark.parametrize("runs", [1, 3])
def test_ctrl_c_in_the_model_leaves_estimate_once(method: ReliabilityMethod, runs: int) -> None:
    plain = uqfold.problems.series()
    rules = uqfold.criteria([4.0, 5.0])
    batches = []

    def model(x: Any) -> Any:
        batches.append(len(x))
        if len(batches) == runs:
            press()
        return plain.model(x)

    problem = uqfold.Problem(model, inputs=plain.inputs.distribution, shared=["X1"], units=4)
    with pytest.raises(KeyboardInterrupt):
        method.estimate(problem, rules, rng=1)
    assert len(batches) == runs


@pytest.mark.parametrize("method", METHODS[1:3], ids=lambda method: method.name)
def test_a_programs_own_handler_is_asked_and_stays(method: ReliabilityMethod) -> None:
    plain = uqfold.problems.series()
    pressed: list[int] = []
    batches: list[int] = []

    def own(number: int, _: Any) -> None:
        pressed.append(number)

    def model(x: Any) -> Any:
        batches.append(len(x))
        if len(batches) == 2:
            press()
            assert pressed  # at once, not after the estimate
        return plain.model(x)

    before = signal.signal(signal.SIGINT, own)
    try:
        problem = uqfold.Problem(model, inputs=plain.inputs.distribution, shared=["X1"], units=4)
        method.estimate(problem, uqfold.criteria([5.0]), max_evals=2000, rng=1)
        assert signal.getsignal(signal.SIGINT) is own
    finally:
        signal.signal(signal.SIGINT, before)
    assert pressed == [signal.SIGINT]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "kind", "place"),
    [
        ("mc", "native", "main"),
        ("mc", "scipy", "main"),
        ("mc", "own", "main"),
        ("mc", "mixture", "thread"),
        ("conditional-mc", "mixture", "main"),
        ("ffni-spa", "copula", "main"),
        ("openturns-mc", "native", "thread"),
        ("openturns-mc", "mixture", "main"),
        ("openturns-form", "own", "main"),
        ("openturns-form", "native", "thread"),
    ],
)
def test_ctrl_c_at_random_moments(method: str, kind: str, place: str) -> None:
    # 3 of 81 ended the process, others were lost
    program = Path(__file__).with_name("ctrl_c.py")
    done = subprocess.run(
        [sys.executable, str(program), method, kind, place, "30", "1"],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        env=os.environ | {"PYTHONWARNINGS": "ignore"},
    )
    assert done.stdout.startswith("30 of 30 interrupted"), done.stderr[-2000:]
