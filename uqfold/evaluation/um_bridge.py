"""Models over HTTP by the UM-Bridge protocol: taken as a model, or served from a problem.

The protocol (https://um-bridge-benchmarks.readthedocs.io/en/docs/umbridge/developing_clients.html)
is JSON over HTTP, and knows models of any language. Only evaluations are spoken here.
"""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

import numpy as np

from uqfold.checks import choice, instance, keep, raised, real, refused, text, whole
from uqfold.evaluation.errors import ExternalRunError
from uqfold.evaluation.row_model import RowModel
from uqfold.problems.base import Problem
from uqfold.problems.responses import one_number
from uqfold.typing import FloatArray

PROTOCOL = 1.0
_POLL_SECONDS = 0.05


@dataclass(frozen=True)
class UMBridgeModel(RowModel):
    """A model that a UM-Bridge server offers.

    A run fails where the server refuses it, does not answer in time, or returns no number.

    Attributes
    ----------
    url
        Where the server listens, as in ``http://localhost:4242``.
    name
        Which of its models.
    output
        Which number of its output is the response, counted from 0 over all its vectors.
    config
        Settings of the model, as it documents them.
    timeout
        Seconds that one run may take.
    parallel
        Runs at the same time, where no executor is given.
    sizes
        Lengths of the model's input vectors, which share the inputs in turn; asked of the server.

    Raises
    ------
    TypeError, ValueError
        If a setting is out of range, nobody answers there, or the server has no such model.
    """

    url: str
    name: str
    output: int = 0
    config: Mapping[str, Any] = field(default_factory=dict)
    timeout: float = field(default=3600.0, compare=False)
    parallel: int = field(default=1, compare=False)
    sizes: tuple[int, ...] = field(init=False)

    def __post_init__(self) -> None:
        keep(self, "url", text)
        keep(self, "name", text)
        keep(self, "output", whole, at_least=0)
        keep(self, "config", instance, (Mapping,), "give a dict")
        keep(self, "timeout", real, above=0.0, what="number of seconds")
        keep(self, "parallel", whole, at_least=1)
        if not self.url.startswith(("http://", "https://")):
            raise refused("url", self.url, "give an address, as in http://localhost:4242")
        try:
            choice("name", self.name, self._asked("Info")["models"])
            found = self._asked("InputSizes", config=dict(self.config))["inputSizes"]
        except ExternalRunError as error:
            raise refused("url", self.url, str(error)) from error
        object.__setattr__(self, "sizes", tuple(int(size) for size in found))

    def run(self, x: FloatArray) -> float:
        """Return the response of one sample x (d,).

        Raises
        ------
        ExternalRunError
            If the run fails.
        ValueError
            If the model takes another number of inputs.
        """
        if x.size != sum(self.sizes):
            raise ValueError(f"{self.name} takes {sum(self.sizes)} inputs, not {x.size}")
        parts = np.split(x, np.cumsum(self.sizes)[:-1])
        asked = {"input": [part.tolist() for part in parts], "config": dict(self.config)}
        numbers = [one for vector in self._asked("Evaluate", **asked)["output"] for one in vector]
        if self.output >= len(numbers):
            raise ExternalRunError(f"{self.name} returned {len(numbers)} numbers only")
        return float(numbers[self.output])

    def _asked(self, what: str, **content: Any) -> Any:
        """Return what the server answers; `Info` alone is asked without a name."""
        body = None if what == "Info" else json.dumps({"name": self.name, **content}).encode()
        request = Request(f"{self.url.rstrip('/')}/{what}", data=body)
        try:
            with urlopen(request, timeout=self.timeout) as response:
                answer = json.load(response)
        except HTTPError as error:
            raise ExternalRunError(_told(error)) from error
        except (URLError, OSError, ValueError) as error:
            raise ExternalRunError(f"{self.url} does not answer: {raised(error)}") from error
        if "error" in answer:
            raise ExternalRunError(_said(answer))
        return answer


def _said(answer: Any) -> str:
    return ": ".join(str(answer["error"].get(key, "")) for key in ("type", "message"))


def _told(error: HTTPError) -> str:
    """Return what a refusing server said."""
    try:
        return _said(json.load(error))
    except (ValueError, KeyError, TypeError, AttributeError):
        return f"HTTP {error.code}"


class ServedProblem:
    """The model of a problem, served as a UM-Bridge model until it is closed.

    Its one input vector has the problem's inputs, shared ones first; its output is the response.
    One run is made at a time. It listens on this machine alone, unless another host is given.

    Parameters
    ----------
    problem
        Whose model is served, under its name.
    port
        Where to listen; 0 takes a free port.
    host
        On which address.

    Raises
    ------
    TypeError, ValueError
        If it is not a problem whose units share one model, or the port is out of range or taken.

    Examples
    --------
    >>> from uqfold.problems import series
    >>> with ServedProblem(series()) as served:
    ...     model = UMBridgeModel(served.url, "series")
    ...     round(model.run(series().inputs.means), 4)
    -6.0741
    """

    def __init__(self, problem: Problem, port: int = 0, host: str = "127.0.0.1") -> None:
        instance("problem", problem, Problem, "give a Problem")
        if len(problem.kinds.models) > 1:
            raise refused("problem", problem, "give one whose units share one model")
        self.problem = problem
        self._one_at_a_time = threading.Lock()
        at = (text("host", host), whole("port", port, at_least=0, at_most=65_535))
        try:
            self._server = ThreadingHTTPServer(at, _handler(self))
        except OSError as error:
            raise refused("port", port, f"{error.strerror} on {host}: give another one") from error
        self._server.daemon_threads = True
        self.url = f"http://{host}:{self._server.server_port}"
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(_POLL_SECONDS,), daemon=True
        )
        self._thread.start()

    def __enter__(self) -> ServedProblem:
        """Return the served problem."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop serving."""
        self.close()

    def wait(self) -> None:
        """Wait until it is closed, by another thread, or Ctrl-C."""
        while self._thread.is_alive():
            self._thread.join(0.2)

    def close(self) -> None:
        """Stop serving."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def _answer(self, what: str, asked: Mapping[str, Any]) -> dict[str, Any]:
        """Return the answer to one request.

        Raises
        ------
        ValueError
            If it is none that a client may ask.
        """
        if what == "Info":
            return {"protocolVersion": PROTOCOL, "models": [self.problem.name]}
        if asked.get("name") != self.problem.name:
            raise ValueError(f"name = {asked.get('name')!r}: the model is {self.problem.name!r}")
        if what == "ModelInfo":
            knows = ("Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian")
            return {"support": {one: one == "Evaluate" for one in knows}}
        dimension = self.problem.inputs.dimension
        if what == "InputSizes":
            return {"inputSizes": [dimension]}
        if what == "OutputSizes":
            return {"outputSizes": [1]}
        if what != "Evaluate":
            raise ValueError(f"{what}: only evaluations are offered")
        given = asked.get("input")
        shape = [len(one) if isinstance(one, list) else 0 for one in given or ()]
        if shape != [dimension]:
            names = ", ".join(self.problem.inputs.names)
            raise ValueError(f"input = {given!r}: give one vector of {dimension} numbers: {names}")
        with self._one_at_a_time:
            y = one_number(self.problem.model(np.array(given, dtype=np.float64))[0])
        if math.isnan(y):
            raise ValueError("the run failed: the response is NaN")
        return {"output": [[float(y)]]}


def _handler(served: ServedProblem) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self._reply(b"")

        def do_POST(self) -> None:
            self._reply(self.rfile.read(int(self.headers.get("Content-Length", 0))))

        def _reply(self, content: bytes) -> None:
            code = 200
            try:
                asked = json.loads(content) if content else {}
                answer = served._answer(self.path.strip("/"), asked)
            except ValueError as error:
                code, answer = 400, {"error": {"type": "InvalidInput", "message": str(error)}}
            except Exception as error:
                code, answer = 500, {"error": {"type": "ModelError", "message": raised(error)}}
            body = json.dumps(answer).encode()
            self.send_response(code)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: Any) -> None:
            """Say nothing of each request."""

    return Handler
