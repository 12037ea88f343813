"""Saved ask-and-tell sessions: a NumPy archive without pickled objects.

It holds what identifies the run (method and settings, problem, criteria, seed, budget, policy for
failed runs) and the rows and responses so far. A session is resumed by replaying these.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from uqfold.checks import shown
from uqfold.evaluation import EvaluationSession
from uqfold.methods.session_lock import LockedError, locked
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import BoolArray, FloatArray, IntArray
from uqfold.writing import replacing

SCHEMA = "uqfold-session/2"
WITHOUT_DIGEST = "uqfold-session/1"
"""The former schema, whose arrays only the checksums of the archive guard."""

_ARRAYS = ("x", "y", "told", "rows")


class SessionFileError(ValueError):
    """A session file is damaged, is none, or belongs to another run."""


@dataclass(frozen=True, eq=False)
class SavedSession:
    """The content of a session file.

    Attributes
    ----------
    path
        The file.
    header
        What identifies the run.
    x, y, told
        Rows X (n, d) in the order in which they were asked for, responses (n,), and which of them
        were told (n,).
    """

    path: Path
    header: Mapping[str, Any]
    x: FloatArray
    y: FloatArray
    told: BoolArray

    def check_belongs_to(self, expected: Mapping[str, Any]) -> None:
        """Compare with the header of the run that wants to go on from here.

        Raises
        ------
        SessionFileError
            Naming what differs.
        """
        for key, value in expected.items():
            if self.header.get(key) != value:
                raise SessionFileError(
                    f"{self.path} belongs to another run: its {key} is "
                    f"{shown(self.header.get(key))}, here it is {shown(value)}"
                )


def header(
    method: object,
    problem: Problem,
    criteria: Iterable[Criterion],
    seed: int,
    session: EvaluationSession,
) -> dict[str, Any]:
    """Return what identifies a run, in values that JSON keeps exactly."""
    return {
        "method": repr(method),
        "problem": problem.name,
        "version": problem.version,
        "inputs": list(problem.inputs.names),
        "n_shared": problem.inputs.n_shared,
        "distribution": " ".join(one.fingerprint for one in problem.kinds.inputs),
        "units": problem.n_units,
        **_differences(problem),
        "structure": repr(problem.structure),
        "criteria": [repr(criterion) for criterion in criteria],
        "seed": seed,
        "max_evals": session.max_evals,
        "failed_runs": session.failed_runs,
    }


def _differences(problem: Problem) -> dict[str, list[Any]]:
    """Return what sets units apart that differ by more than their own draws."""
    if problem.exchangeable or isinstance(problem.units, int):
        return {}
    offsets = [unit.offset for unit in problem.units]
    found: dict[str, list[Any]] = {"names": list(problem.unit_names), "offsets": offsets}
    if len(problem.kinds.models) > 1 and problem.kinds.of_units is not None:
        found["kinds"] = problem.kinds.of_units.tolist()
    return found


def write(
    path: str | PathLike[str],
    head: Mapping[str, Any],
    batches: Sequence[tuple[FloatArray, FloatArray]],
    told: BoolArray,
) -> None:
    """Write a session file, replacing at once a former one of which nothing is lost.

    Several processes may save to the same file: they do so one after the other.

    Raises
    ------
    SessionFileError
        If there is a file of another run, one with responses that these batches have not, or
        something else; or if another process does not end writing. The file is left as it is.
    OSError
        If the file cannot be written.
    """
    target = Path(path)
    x = np.concatenate([x for x, _ in batches]) if batches else np.empty((0, 0))
    y = np.concatenate([y for _, y in batches]) if batches else np.empty(0)
    try:
        with locked(target):
            if target.exists() and target.stat().st_size:
                _check_kept(read(target), head, x, y, told)
            with replacing(target) as stream:
                text = json.dumps({"schema": SCHEMA, **head})
                arrays: dict[str, np.ndarray[Any, Any]] = {
                    "x": x,
                    "y": y,
                    "told": told,
                    "rows": np.array([x.shape[0] for x, _ in batches], dtype=np.int64),
                }
                digest = np.array(_digest(text, arrays.values()))
                np.savez(stream, header=np.array(text), digest=digest, **arrays)  # type: ignore[arg-type]
    except LockedError as error:
        raise SessionFileError(f"{target} cannot be saved: {error}") from error


def _check_kept(
    former: SavedSession, head: Mapping[str, Any], x: FloatArray, y: FloatArray, told: BoolArray
) -> None:
    """Refuse to replace a file whose responses are not all among those to be written."""
    former.check_belongs_to(head)
    answered = np.flatnonzero(former.told)
    n = int(answered[-1]) + 1 if answered.size else 0
    kept = n <= y.size and (n == 0 or same_rows(former.x[:n], x[:n]))
    if kept:
        same = np.array_equal(former.y[answered], y[answered], equal_nan=True)
        kept = same and bool(told[answered].all())
    if not kept:
        raise SessionFileError(
            f"{former.path} holds responses that this session has not, told to another one "
            "of the same run: resume that file, save to another, or remove it"
        )


def read(path: str | PathLike[str]) -> SavedSession:
    """Read a session file.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    SessionFileError
        If it is damaged, or not a session file of this format.
    """
    source = Path(path)
    try:
        with source.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            text = str(archive["header"])
            head = json.loads(text)
            x, y, told, rows = (archive[name] for name in _ARRAYS)
            digest = str(archive["digest"]) if "digest" in archive else None
    except FileNotFoundError:
        raise
    # what a damaged archive makes of NumPy, zip and JSON has no common kind: too deeply nested,
    # too large for the memory, an unknown compression, a number of too many digits, ...
    except Exception as error:
        why = f"is not a session file, or a damaged one: {str(error) or type(error).__name__}"
        raise SessionFileError(f"{source} {why}") from error
    if not isinstance(head, dict) or head.get("schema") not in {SCHEMA, WITHOUT_DIGEST}:
        raise SessionFileError(f"{source} does not follow the format {SCHEMA!r}")
    if not _consistent(x, y, told, rows):
        raise SessionFileError(f"{source} is damaged: its arrays do not fit together")
    if not {"seed", "max_evals"} <= head.keys() or not _sound(head["seed"], head["max_evals"]):
        raise SessionFileError(f"{source} is damaged: it states no seed, or no budget")
    guarded = head["schema"] == SCHEMA or digest is not None
    if guarded and digest != _digest(text, (x, y, told, rows)):
        raise SessionFileError(f"{source} is damaged: it does not have the digest that it states")
    return SavedSession(source, head, x, y, told)


def _digest(header: str, arrays: Iterable[np.ndarray[Any, Any]]) -> str:
    """Digest of all that a file holds, apart from the checksums of the archive itself."""
    whole = hashlib.sha256(header.encode())
    for one in arrays:
        whole.update(f"{one.dtype.str} {one.shape} ".encode())
        whole.update(np.ascontiguousarray(one).tobytes())
    return whole.hexdigest()


def _sound(seed: object, max_evals: object) -> bool:
    kinds = type(seed) is int and type(max_evals) in (int, type(None))
    return kinds and seed >= 0 and (max_evals is None or max_evals >= 1)  # type: ignore[operator]


def _consistent(x: FloatArray, y: FloatArray, told: BoolArray, rows: IntArray) -> bool:
    shapes_fit = x.ndim == 2 and y.shape == told.shape == x.shape[:1] and rows.ndim == 1
    kinds_fit = x.dtype == y.dtype == np.float64 and told.dtype == np.bool_
    if not (shapes_fit and kinds_fit and rows.dtype == np.int64):
        return False
    # counted by Python, which has no largest number
    return min(rows.tolist(), default=1) >= 0 and sum(rows.tolist()) == y.size


def same_rows(a: FloatArray, b: FloatArray) -> bool:
    """Whether two sets of rows agree up to the last digits, which may differ between machines."""
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=1e-9, atol=1e-12))
