"""Models over HTTP: a problem is served, and taken as a model again."""

import json
from collections.abc import Iterator
from urllib.request import Request, urlopen

import numpy as np
import pytest

import uqfold
from uqfold.cli import main
from uqfold.evaluation import ServedProblem, UMBridgeModel
from uqfold.evaluation.errors import ExternalRunError
from uqfold.inputs import normal
from uqfold.problems import Problem


def sag(x: np.ndarray) -> np.ndarray:
    """Fails for negative loads; infinite without stiffness."""
    with np.errstate(divide="ignore"):
        return np.where(x[:, 0] < 0.0, np.nan, x[:, 0] / np.abs(x[:, 1]))


PROBLEM = Problem(sag, individual={"load": normal(2.0, 0.5), "stiffness": normal(9.0, 1.0)})


@pytest.fixture(scope="module")
def served() -> Iterator[ServedProblem]:
    with ServedProblem(PROBLEM) as running:
        yield running


def test_a_served_problem_answers_as_the_model_itself(served: ServedProblem) -> None:
    """Bit for bit, an infinite response included; a failed run says why."""
    model = UMBridgeModel(served.url, "sag", parallel=2)
    assert model.sizes == (2,)
    x = np.array([[1.0, 3.0], [0.1, 7.0], [1.0, 0.0]])
    np.testing.assert_array_equal([model.run(row) for row in x], sag(x))
    with pytest.raises(ExternalRunError, match="the run failed: the response is NaN"):
        model.run(np.array([-1.0, 1.0]))
    method, remote = uqfold.methods.MonteCarlo(systems=20), Problem(model, inputs=PROBLEM.inputs)
    found, known = (method.estimate(one, 0.2, rng=1) for one in (remote, PROBLEM))
    assert found.pf.tolist() == known.pf.tolist()


def test_the_protocol_is_spoken(served: ServedProblem) -> None:
    def asked(what: str, **content: object) -> object:
        body = json.dumps(content).encode() if content else None
        with urlopen(Request(f"{served.url}/{what}", data=body)) as response:
            return json.load(response)

    assert asked("Info") == {"protocolVersion": 1.0, "models": ["sag"]}
    support = {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}
    assert asked("ModelInfo", name="sag") == {"support": support}
    assert asked("OutputSizes", name="sag", config={}) == {"outputSizes": [1]}
    assert asked("Evaluate", name="sag", input=[[1.0, 4.0]], config={}) == {"output": [[0.25]]}


def test_what_does_not_fit_is_told(served: ServedProblem) -> None:
    with pytest.raises(ValueError, match="did you mean 'sag'"):
        UMBridgeModel(served.url, "sagg")
    with pytest.raises(ValueError, match=r"url = 'localhost:4242': give an address"):
        UMBridgeModel("localhost:4242", "sag")
    with pytest.raises(ValueError, match="sag takes 2 inputs, not 3"):
        UMBridgeModel(served.url, "sag").run(np.zeros(3))
    with pytest.raises(ExternalRunError, match="sag returned 1 numbers only"):
        UMBridgeModel(served.url, "sag", output=1).run(np.ones(2))
    with pytest.raises(ExternalRunError, match=r"give one vector of 2 numbers: load, stiffness"):
        UMBridgeModel(served.url, "sag")._asked("Evaluate", input=[[1.0]])
    with ServedProblem(PROBLEM) as other:
        gone = UMBridgeModel(other.url, "sag", timeout=5.0)
    with pytest.raises(ExternalRunError, match="does not answer"):
        gone.run(np.ones(2))
    with pytest.raises(ValueError, match=r"url = .* does not answer"):
        UMBridgeModel(other.url, "sag")
    port = int(served.url.rpartition(":")[2])
    with pytest.raises(ValueError, match=f"port = {port}: .* on 127.0.0.1: give another one"):
        ServedProblem(PROBLEM, port)
    kinds = Problem(sag, individual=PROBLEM.inputs.distribution, units=[uqfold.Unit(sum_of)] * 2)
    with pytest.raises(ValueError, match="give one whose units share one model"):
        ServedProblem(Problem(sag, inputs=PROBLEM.inputs, units=[uqfold.Unit(), *kinds.units[:1]]))


def sum_of(x: np.ndarray) -> np.ndarray:
    return x.sum(axis=1)


def test_the_command_serves_until_it_is_ended(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    found: list[float] = []

    def ask_once(self: ServedProblem) -> None:
        found.append(UMBridgeModel(self.url, "series").run(np.ones(3)))

    monkeypatch.setattr(ServedProblem, "wait", ask_once)
    with pytest.raises(SystemExit, match="0"):
        main(["serve", "series", "--port", "0"])
    assert found == uqfold.problems.series().model(np.ones((1, 3))).tolist()
    assert capsys.readouterr().out.startswith("series (X1, X2, X3) at http://127.0.0.1:")
