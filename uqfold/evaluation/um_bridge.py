"""Models over HTTP by the UM-Bridge protocol: taken as a model.

The protocol (https://um-bridge-benchmarks.readthedocs.io/en/docs/umbridge/developing_clients.html)
is JSON over HTTP, and knows models of any language. Only evaluations are spoken here. JSON has no
infinite numbers: ``1e999`` stands for one, which readers in double precision take as infinity; the
words that Python writes (``Infinity``) are understood too.
"""

from __future__ import annotations

import copy
import io
import json
import math
import re
import socket
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from uqfold.checks import (
    choice,
    keep,
    listed,
    mapping,
    names,
    raised,
    real,
    refused,
    several,
    shown,
    text,
    whole,
)
from uqfold.evaluation.errors import ExternalRunError
from uqfold.evaluation.row_model import RowModel
from uqfold.typing import FloatArray

PROTOCOL = 1.0
INFINITY = "1e999"
MOST_BYTES = 1 << 26
"""Of a request or an answer."""
_LONGEST_WAIT = 1e6
_SIZES = (
    ("InputSizes", "inputSizes", "sizes"),
    ("OutputSizes", "outputSizes", "output_sizes"),
)
"""What is asked, the field of its answer, and where it is kept."""


@dataclass(frozen=True)
class UMBridgeModel(RowModel):
    """A model that a UM-Bridge server offers.

    A run fails where the server refuses it, does not answer in time, or returns something else
    than vectors of numbers with the lengths that it has stated.

    Attributes
    ----------
    url
        Where the server listens, as in ``http://localhost:4242``.
    name
        Which of its models.
    output
        Which number of its output is the response, counted from 0 over all its vectors.
    config
        Settings of the model, as it documents them: what JSON can hold.
    timeout
        Seconds that one run may take, from connecting to the last byte of the answer.
    parallel
        Runs at the same time, where no executor is given.
    sizes
        Lengths of the model's input vectors, which share the inputs in turn; asked of the server.
    output_sizes
        Lengths of its output vectors, likewise.

    Raises
    ------
    TypeError, ValueError
        If a setting is out of range, nobody answers there, the server has no such model, or what
        it tells of it is not as the protocol has it.
    """

    url: str
    name: str
    output: int = 0
    config: Mapping[str, Any] = field(default_factory=dict, hash=False)
    timeout: float = field(default=3600.0, compare=False)
    parallel: int = field(default=1, compare=False)
    sizes: tuple[int, ...] = field(init=False)
    output_sizes: tuple[int, ...] = field(init=False)

    def __post_init__(self) -> None:
        keep(self, "url", _address)
        keep(self, "name", text)
        keep(self, "output", whole, at_least=0)
        keep(self, "config", _settings)
        keep(self, "timeout", real, above=0.0, what="number of seconds")
        keep(self, "parallel", whole, at_least=1)
        try:
            self._ask_about_model()
        except ExternalRunError as error:
            raise refused("url", self.url, str(error)) from error
        if self.output >= sum(self.output_sizes):
            many = f"{self.name} returns {sum(self.output_sizes)} numbers"
            raise refused("output", self.output, f"{many}, give one of them, counted from 0")

    def run(self, x: FloatArray) -> float:
        """Return the response of one sample x (d,).

        Raises
        ------
        ExternalRunError
            If the run fails.
        ValueError
            If the model takes another number of inputs, or one of them is not finite.
        """
        if x.size != sum(self.sizes):
            raise ValueError(f"{self.name} takes {sum(self.sizes)} inputs, not {x.size}")
        if not np.isfinite(x).all():
            raise ValueError(f"{self.name} takes finite inputs, not {shown(x.tolist())}")
        parts = np.split(x, np.cumsum(self.sizes)[:-1])
        try:
            given = self._field("Evaluate", "output", input=[one.tolist() for one in parts])
            vectors = several("output", given, listed)
            if tuple(map(len, vectors)) != self.output_sizes:
                stated = ", ".join(map(str, self.output_sizes))
                raise refused("output", given, f"{self.name} has stated vectors of {stated}")
            responses = [one for vector in vectors for one in vector]
            return real("output", responses[self.output], finite=False)
        except (TypeError, ValueError) as error:
            raise ExternalRunError(f"{self.url} does not answer with numbers: {error}") from error

    def with_time_limit(self, seconds: float) -> UMBridgeModel:
        """Return the same model with a timeout of at most that."""
        limited = copy.copy(self)
        object.__setattr__(limited, "timeout", min(seconds, self.timeout))
        return limited

    def _ask_about_model(self) -> None:
        """Keep what the server tells of the model."""
        try:
            known = self._asked("Info")
            version = real("protocolVersion", known.get("protocolVersion"))
            if version != PROTOCOL:
                raise refused("protocolVersion", version, f"the one spoken here is {PROTOCOL}")
            models = names("models", known.get("models"))
        except (TypeError, ValueError) as error:
            raise ExternalRunError(f"it is no UM-Bridge server: {error}") from error
        choice("name", self.name, models)
        try:
            support = self._asked("ModelInfo").get("support")
            if not isinstance(support, Mapping) or support.get("Evaluate") is not True:
                raise refused("support", support, f"{self.name} cannot be evaluated")
            for what, name, kept in _SIZES:
                given = self._field(what, name)
                lengths = several(name, given, whole, at_least=0, at_most=MOST_BYTES)
                if not sum(lengths):
                    raise refused(name, given, "at least one number is needed")
                object.__setattr__(self, kept, lengths)
        except (TypeError, ValueError) as error:
            raise ExternalRunError(f"it does not tell of {self.name}: {error}") from error

    def _field(self, what: str, name: str, **content: Any) -> tuple[Any, ...]:
        """Return the list that an answer holds by a name."""
        return listed(name, self._asked(what, config=self.config, **content).get(name))

    def _asked(self, what: str, **content: Any) -> dict[str, Any]:
        """Return what the server answers; `Info` alone is asked without a name."""
        asked = None if what == "Info" else json.dumps({"name": self.name, **content}).encode()
        try:
            status, body = _exchanged(f"{self.url}/{what}", asked, self.timeout)
        except TimeoutError:
            raise ExternalRunError(f"{self.url} does not answer in {self.timeout:g} s") from None
        except (OSError, ValueError, HTTPException) as error:
            raise ExternalRunError(f"{self.url} does not answer: {raised(error)}") from error
        answer: Any = None
        try:
            answer = json.loads(body, parse_float=_number)
        except (ValueError, RecursionError) as error:
            if status == 200:
                said = f"{self.url}/{what} answers with no JSON: {raised(error)}"
                raise ExternalRunError(said) from error
        if isinstance(answer, dict) and "error" in answer:
            raise ExternalRunError(_said(answer["error"]))
        if status != 200:
            raise ExternalRunError(f"{self.url}/{what} answers with HTTP {status}")
        if not isinstance(answer, dict):
            raise ExternalRunError(f"{self.url}/{what} answers with {shown(answer)}, no object")
        return answer


def _exchanged(url: str, content: bytes | None, seconds: float) -> tuple[int, bytes]:
    """Return status and body of the answer to a request, all of which takes so long at most.

    Raises
    ------
    TimeoutError
        If it is not there by then, also where the server sends a byte now and then.
    OSError, ValueError, http.client.HTTPException
        If there is none, or it is too long.
    """
    end = time.monotonic() + seconds
    at = urlsplit(url)
    kind = HTTPSConnection if at.scheme == "https" else HTTPConnection
    link = kind(at.hostname or "", at.port, timeout=_left(end))
    try:
        link.connect()
        link.sock.settimeout(_left(end))
        method, headers = "GET" if content is None else "POST", {"Content-Type": "application/json"}
        link.request(method, at.path, content, headers)
        response = HTTPResponse(_Reader(link.sock, end), method=method)  # type: ignore[arg-type]
        response.begin()
        body = response.read(MOST_BYTES + 1)
        if len(body) > MOST_BYTES:
            raise ValueError(f"its answer has more than {MOST_BYTES} bytes")
        return response.status, body
    finally:
        link.close()


class _Reader(io.RawIOBase):
    """A socket that is read until a point in time."""

    def __init__(self, link: socket.socket, end: float) -> None:
        self._link, self._end = link, end

    def makefile(self, mode: str) -> io.BufferedReader:
        """Return the stream of its bytes, as a socket does."""
        del mode
        return io.BufferedReader(self)

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        """Read what is there, or wait for it."""
        self._link.settimeout(_left(self._end))
        return self._link.recv_into(buffer)


def _left(end: float) -> float:
    """Return the seconds that are left, as many of them as a socket can wait."""
    left = end - time.monotonic()
    if left <= 0.0:
        raise TimeoutError
    return min(left, _LONGEST_WAIT)


def _address(name: str, value: object) -> str:
    """Return the address of a server without a slash at its end."""
    given = text(name, value)
    remedy = "give an address, as in http://localhost:4242"
    try:
        at = urlsplit(given)
        at.port  # noqa: B018 - raises for a wrong one
        (at.hostname or "").encode("idna")
    except ValueError as error:
        raise refused(name, given, f"{remedy} ({error})") from None
    plain = not re.search(r"[^!-~]", given) and not at.query and not at.fragment
    if at.scheme not in ("http", "https") or not at.hostname or "@" in at.netloc or not plain:
        raise refused(name, given, remedy)
    return given.rstrip("/")


def _settings(name: str, value: object) -> dict[str, Any]:
    """Return settings as the server will read them, a copy that stays as it is."""
    given = mapping(name, value, lambda _, item: item)
    try:
        copied: dict[str, Any] = json.loads(json.dumps(given, allow_nan=False))
    except (TypeError, ValueError, RecursionError) as error:
        raise refused(name, value, f"give what JSON can hold ({raised(error)})") from None
    return copied


def _number(written: str) -> float:
    """Return a number of JSON; one that is too large is NaN, unless it stands for infinity."""
    value = float(written)
    endless = math.isinf(value) and written.lstrip("-").lower() != INFINITY
    return math.nan if endless else value


def _said(error: Any) -> str:
    """Return what a refusing server said."""
    if not isinstance(error, Mapping):
        return shown(error)
    told = [str(error[key]) for key in ("type", "message") if error.get(key)]
    return ": ".join(told) or shown(error)
