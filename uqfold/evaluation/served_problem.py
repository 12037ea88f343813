"""The model of a problem over HTTP, by the UM-Bridge protocol."""

from __future__ import annotations

import json
import math
import socket
import sys
import threading
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any

import numpy as np

from uqfold.checks import instance, one_line, raised, real, refused, shown, text, whole
from uqfold.documents import parsed_json
from uqfold.evaluation.um_bridge import INFINITY, MOST_BYTES, PROTOCOL
from uqfold.problems.base import Problem
from uqfold.problems.responses import one_number
from uqfold.typing import FloatArray

_POLL_SECONDS = 0.05
_READ_SECONDS = 60.0
"""A client that is silent for so long in the middle of its request is left."""


class _RefusedError(Exception):
    """A request that is answered by an error, as the protocol has it: its type and a message."""

    def __init__(self, kind: str, message: str, status: int = HTTPStatus.BAD_REQUEST) -> None:
        super().__init__(message)
        self.kind, self.status = kind, status


class ServedProblem:
    """The model of a problem, served as a UM-Bridge model until it is closed.

    Its one input vector has the problem's inputs, shared ones first; its output is the response,
    an infinite one as ``1e999``. One run is made at a time. It listens on this machine alone,
    unless another host is given. A request that is not as the protocol has it is refused with the
    reason, and so is one with settings (``config``), since the model has none.

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
    >>> from uqfold.evaluation import UMBridgeModel
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
            self._server = _Server(at, _handler(self))
        except (socket.gaierror, UnicodeError) as error:
            raise refused("host", host, f"give an address of this machine ({error})") from error
        except OSError as error:
            raise refused("port", port, f"{error.strerror} on {host}: give another one") from error
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

    def _answer(self, what: str, content: bytes) -> str:
        """Return the answer to one request, as JSON."""
        if what == "Info":
            return json.dumps({"protocolVersion": PROTOCOL, "models": [self.problem.name]})
        try:
            asked = _parsed(content)
            instance("request", asked, dict, "give a JSON object")
            settings = instance("config", asked.get("config", {}), dict, "give an object")
        except (ValueError, TypeError) as error:
            raise _RefusedError("InvalidInput", str(error)) from None
        name, dimension = asked.get("name"), self.problem.inputs.dimension
        if name != self.problem.name:
            said = f"name = {shown(name)}: the model is {self.problem.name!r}"
            raise _RefusedError("ModelNotFound", said)
        if settings:
            raise _RefusedError(
                "InvalidInput", f"config = {shown(settings)}: the model has no settings"
            )
        if what == "ModelInfo":
            knows = ("Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian")
            return json.dumps({"support": {one: one == "Evaluate" for one in knows}})
        if what == "InputSizes":
            return json.dumps({"inputSizes": [dimension]})
        if what == "OutputSizes":
            return json.dumps({"outputSizes": [1]})
        if what != "Evaluate":
            raise _RefusedError(
                "UnsupportedFeature", f"{one_line(what)}: only evaluations are offered"
            )
        y = self._response(self._inputs(asked))
        written = json.dumps(y) if math.isfinite(y) else "-" * (y < 0.0) + INFINITY
        return f'{{"output": [[{written}]]}}'

    def _inputs(self, asked: Mapping[str, Any]) -> FloatArray:
        """Return the rows X (1, d) that are to be evaluated."""
        given, names = asked.get("input"), self.problem.inputs.names
        vectors = given if isinstance(given, list) else []
        lengths = [len(one) if isinstance(one, list) else -1 for one in vectors]
        if lengths != [len(names)]:
            remedy = f"give one vector of {len(names)} numbers: {', '.join(names)}"
            raise _RefusedError("InvalidInput", f"input = {shown(given)}: {remedy}")
        try:
            row = [real(name, one) for name, one in zip(names, vectors[0], strict=True)]
        except (ValueError, TypeError) as error:
            raise _RefusedError("InvalidInput", str(error)) from None
        return np.array([row], dtype=np.float64)

    def _response(self, x: FloatArray) -> float:
        try:
            with self._one_at_a_time:
                y = one_number(self.problem.model(x)[0])
        except (Exception, SystemExit) as error:
            raise _RefusedError(
                "ModelError", raised(error), HTTPStatus.INTERNAL_SERVER_ERROR
            ) from error
        if math.isnan(y):
            said = "the run failed: the response is NaN"
            raise _RefusedError("InvalidOutput", said, HTTPStatus.INTERNAL_SERVER_ERROR)
        return y


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a client that has left."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def _handler(served: ServedProblem) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        timeout = _READ_SECONDS

        def do_GET(self) -> None:
            self._reply(lambda: b"")

        def do_POST(self) -> None:
            self._reply(self._content)

        def send_error(
            self, code: int, message: str | None = None, explain: str | None = None
        ) -> None:
            """Refuse what is not even HTTP, or another method of it."""
            self._send(code, _told("InvalidInput", message or HTTPStatus(code).phrase))

        def _content(self) -> bytes:
            given = self.headers.get("Content-Length")
            remedy = f"give the number of bytes, {MOST_BYTES} at most"
            length = int(given) if given and given.isdecimal() and len(given) < 19 else -1
            if not 0 <= length <= MOST_BYTES:
                raise _RefusedError("InvalidInput", f"Content-Length = {shown(given)}: {remedy}")
            return self.rfile.read(length)

        def _reply(self, content: Any) -> None:
            try:
                status, answer = 200, served._answer(self.path.strip("/"), content())
            except _RefusedError as refusal:
                status, answer = refusal.status, _told(refusal.kind, str(refusal))
            self._send(status, answer)

        def _send(self, status: int, answer: str) -> None:
            body = answer.encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Connection", "close")
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(body)

        def log_message(self, *_: Any) -> None:
            """Say nothing of each request."""

    return Handler


def _parsed(content: bytes) -> Any:
    try:
        return parsed_json(content.decode())
    except ValueError as error:
        raise ValueError(f"it is no JSON: {error}") from None


def _told(kind: str, message: str) -> str:
    return json.dumps({"error": {"type": kind, "message": message}})
