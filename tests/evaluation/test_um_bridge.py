"""Models over HTTP: a problem is served, and taken as a model again."""

import json
import pickle
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from typing import Any
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
    with pytest.raises(ValueError, match="output = 1: sag returns 1 numbers"):
        UMBridgeModel(served.url, "sag", output=1)
    with pytest.raises(ValueError, match="sag takes finite inputs"):
        UMBridgeModel(served.url, "sag").run(np.array([np.inf, 1.0]))
    with pytest.raises(ValueError, match=r"config = {'level': 2}: the model has no settings"):
        UMBridgeModel(served.url, "sag", config={"level": 2})
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
    with pytest.raises(ValueError, match="host = 'no host': give an address of this machine"):
        ServedProblem(PROBLEM, host="no host")
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
    with pytest.raises(SystemExit, match="0"):
        main(["serve", "series", "--port", "0", "--json"])
    told = json.loads(capsys.readouterr().out)
    assert (told["model"], told["inputs"]) == ("series", ["X1", "X2", "X3"])
    assert told["url"].startswith("http://127.0.0.1:")


GOOD = {
    "Info": {"protocolVersion": 1.0, "models": ["sag"]},
    "ModelInfo": {"support": {"Evaluate": True}},
    "InputSizes": {"inputSizes": [1, 1]},
    "OutputSizes": {"outputSizes": [2]},
    "Evaluate": {"output": [[1.0, 2.0]]},
}


@contextmanager
def answering(answers: dict[str, Any], pause: float = 0.0) -> Iterator[str]:
    """A server with these answers, as JSON or as the bytes of the whole reply."""
    listener = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        while True:
            try:
                link, _ = listener.accept()
            except OSError:
                return
            with link, link.makefile("rb") as stream:
                path = stream.readline().split()[1].decode().strip("/")
                length = 0
                while line := stream.readline().strip().lower():
                    length = int(line.split()[1]) if line.startswith(b"content-length") else length
                stream.read(length)
                answer = answers.get(path, {})
                if not isinstance(answer, bytes):
                    answer = b"HTTP/1.0 200 OK\r\n\r\n" + json.dumps(answer).encode()
                try:
                    for byte in answer if path == "Evaluate" and pause else ():
                        link.sendall(bytes([byte]))
                        time.sleep(pause)
                    link.sendall(answer)
                except OSError:
                    pass

    threading.Thread(target=serve, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
    finally:
        listener.shutdown(socket.SHUT_RDWR)
        listener.close()


HTTP = b"HTTP/1.0 200 OK\r\n\r\n"


@pytest.mark.parametrize(
    ("path", "answer"),
    [
        ("Info", ["sag"]),
        ("Info", {"models": ["sag"]}),
        ("Info", {"protocolVersion": 2.0, "models": ["sag"]}),
        ("Info", {"protocolVersion": True, "models": ["sag"]}),
        ("Info", {"protocolVersion": 1.0, "models": "sag"}),
        ("Info", {"protocolVersion": 1.0, "models": [1]}),
        ("Info", HTTP + b"[" * 100_000),
        ("Info", HTTP + b'{"models": \xff}'),
        ("Info", b"SSH-2.0\r\n"),
        ("Info", b""),
        ("Info", b"HTTP/1.0 302 Found\r\nLocation: http://127.0.0.1:1/\r\n\r\n"),
        ("ModelInfo", {"support": {"Evaluate": False}}),
        ("ModelInfo", {"support": ["Evaluate"]}),
        ("InputSizes", {}),
        ("InputSizes", {"inputSizes": {"0": 2}}),
        ("InputSizes", {"inputSizes": [2.5]}),
        ("InputSizes", {"inputSizes": [True]}),
        ("InputSizes", {"inputSizes": ["2"]}),
        ("InputSizes", {"inputSizes": [-1, 3]}),
        ("InputSizes", {"inputSizes": [10**30]}),
        ("InputSizes", {"inputSizes": []}),
        ("OutputSizes", {"outputSizes": 2}),
        ("OutputSizes", {"error": "out of order"}),
        ("Evaluate", {"output": [1.0, 2.0]}),
        ("Evaluate", {"output": [[1.0], [2.0]]}),
        ("Evaluate", {"output": [[1.0, 2.0, 3.0]]}),
        ("Evaluate", {"output": [{"0": 1.0, "1": 2.0}]}),
        ("Evaluate", {"output": [["1.0", "2.0"]]}),
        ("Evaluate", {"output": [[True, 2.0]]}),
        ("Evaluate", {"output": [[None, 2.0]]}),
        ("Evaluate", {"output": [[[1.0], 2.0]]}),
        ("Evaluate", {"output": [[10**400, 2.0]]}),
        ("Evaluate", HTTP + b'{"output": [[1e400, 2.0]]}'),
        ("Evaluate", HTTP + b'{"output": [[NaN, 2.0]]}'),
        ("Evaluate", HTTP + b'{"output": [[1.0, '),
        ("Evaluate", {"output": "12"}),
        ("Evaluate", {"error": {"message": {"at": "line 3"}}}),
        ("Evaluate", {"error": None}),
        ("Evaluate", b"HTTP/1.0 500 Oh\r\n\r\n<html>"),
    ],
)
def test_a_wrong_answer_is_never_a_response(path: str, answer: object) -> None:
    """Of whatever kind: told in one line when the model is made, or a failed run."""
    with answering(GOOD | {path: answer}) as url:
        if path != "Evaluate":
            with pytest.raises(ValueError, match=f"url = '{url}': ") as refused:
                UMBridgeModel(url, "sag")
        else:
            model = UMBridgeModel(url, "sag")
            with pytest.raises(ExternalRunError) as refused:
                model.run(np.ones(2))
    assert "\n" not in str(refused.value)


def test_infinite_responses_of_other_servers_are_understood() -> None:
    for written in (b"1e999", b"Infinity", b"1E999"):
        with answering(GOOD | {"Evaluate": HTTP + b'{"output": [[-%b, 2]]}' % written}) as url:
            assert UMBridgeModel(url, "sag").run(np.ones(2)) == -np.inf
            assert UMBridgeModel(url, "sag", output=1).run(np.ones(2)) == 2.0


def test_the_time_of_a_run_is_kept_by_a_slow_server() -> None:
    """Though a byte comes now and then; a method may ask for less time than the model's own."""
    with answering(GOOD, pause=0.05) as url:
        model = UMBridgeModel(url, "sag")
        for limited in (UMBridgeModel(url, "sag", timeout=0.2), model.with_time_limit(0.2)):
            start = time.monotonic()
            with pytest.raises(ExternalRunError, match=r"does not answer in 0.2 s"):
                limited.run(np.ones(2))
            assert time.monotonic() - start < 1.0
    assert model.timeout == 3600.0


@pytest.mark.parametrize(
    "url",
    ["http://", "http://a:b", "http://a:99999", "http://u:p@a", "http://a b", "http://[::1",
     "http://a?x=1", "http://a/\u00fc", "ftp://a", f"http://{'a' * 70}.b", "http://a\n"],
)  # fmt: skip
def test_a_wrong_address_is_refused_before_anything_is_sent(url: str) -> None:
    with pytest.raises(ValueError, match=r"url = .*give an address, as in http://localhost:4242"):
        UMBridgeModel(url, "sag")


def test_settings_are_what_json_can_hold(served: ServedProblem) -> None:
    loop: dict[str, object] = {}
    loop["itself"] = loop
    for config in ({"a": np.ones(2)}, {"a": float("nan")}, loop):
        with pytest.raises(ValueError, match=r"config = .*give what JSON can hold"):
            UMBridgeModel(served.url, "sag", config=config)
    with answering(GOOD) as url:
        given = {"levels": [1]}
        model, same = UMBridgeModel(url, "sag", config=given), UMBridgeModel(url, "sag")
        given["levels"].append(2)
    assert model.config == {"levels": [1]}
    assert pickle.loads(pickle.dumps(model)) == model != same
    assert len({model, same, pickle.loads(pickle.dumps(model))}) == 2


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "InvalidInput: it is no JSON"),
        (b"[]", "InvalidInput: request = []: give a JSON object"),
        (b"[" * 100_000, "nested too deeply"),
        (b"\xff", "it is no JSON"),
        (b'{"name": "other"}', "ModelNotFound: name = 'other': the model is 'sag'"),
        (b'{"name": "sag", "input": [[1.0, NaN]]}', "NaN is not JSON"),
        (b'{"name": "sag", "input": [[1.0, 1e999]]}', "the number 1e999 is too large"),
        (b'{"name": "sag", "input": [["1.0", 2.0]]}', "load = '1.0': give a finite number"),
        (b'{"name": "sag", "input": [[true, 2.0]]}', "load = True: give a finite number"),
        (b'{"name": "sag", "input": [[null, 2.0]]}', "load = None: give a finite number"),
        (b'{"name": "sag", "input": [[[1.0], 2.0]]}', "load = [1.0]: give a finite number"),
        (b'{"name": "sag", "input": [[1.0, 2.0, 3.0]]}', "give one vector of 2 numbers"),
        (b'{"name": "sag", "input": {"ab": 1}}', "give one vector of 2 numbers"),
        (b'{"name": "sag", "input": 3}', "give one vector of 2 numbers"),
        (b'{"name": "sag", "input": [[1.0, 2.0]], "config": 3}', "config = 3: give an object"),
        (b'{"name": "sag", "input": [[-1.0, 2.0]]}', "InvalidOutput: the run failed"),
    ],
)
def test_a_wrong_request_is_refused_as_the_protocol_has_it(
    served: ServedProblem, content: bytes, told: str
) -> None:
    assert told in refusal(served, "POST", "/Evaluate", content)


def refusal(served: ServedProblem, method: str, path: str, content: Any, **headers: str) -> str:
    """Type and message of the error that answers a request."""
    link = HTTPConnection("127.0.0.1", int(served.url.rpartition(":")[2]), timeout=5.0)
    link.request(method, path, content, headers)
    response = link.getresponse()
    error = json.load(response)["error"]
    link.close()
    assert response.status >= 400
    return f"{error['type']}: {error['message']}"


def test_what_is_hardly_http_is_refused_too(
    served: ServedProblem, capsys: pytest.CaptureFixture[str]
) -> None:
    for length in ("-1", "many", "1e3", "10" * 20):
        said = refusal(served, "POST", "/Evaluate", b"{}", **{"Content-Length": length})
        assert f"Content-Length = '{length}': give the number of bytes" in said
    assert "UnsupportedFeature" in refusal(served, "POST", "/Gradient", b'{"name": "sag"}')
    assert "Unsupported method" in refusal(served, "PUT", "/Evaluate", b"{}")
    with socket.create_connection(("127.0.0.1", int(served.url.rpartition(":")[2]))) as link:
        link.sendall(b"nonsense\r\n\r\n")
        assert b'"error"' in link.recv(1000)
    assert capsys.readouterr().err == ""
