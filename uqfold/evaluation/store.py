"""Responses kept on disk: one SQLite file that outlives killed runs and serves later ones.

An entry holds the responses of a few rows of inputs, and is found by a digest of the model's
identity and of these inputs, bit for bit. Nothing else can find it, so that a store holds the runs
of many models, and an entry that is not there only costs its runs.

Every entry carries a checksum over its key and content. Each `Store.put` is one transaction,
written through to the disk: after a kill or a loss of power the file holds whole transactions.
"""

from __future__ import annotations

import hashlib
import os
import sqlite3
import threading
import weakref
from collections.abc import Iterable, Sequence
from contextlib import suppress
from os import PathLike
from pathlib import Path
from types import TracebackType

import numpy as np

from uqfold import checks
from uqfold.evaluation.errors import StoreError
from uqfold.typing import FloatArray

APPLICATION_ID = 0x7571666F
"""Marks an SQLite file as a store ("uqfo")."""
FORMAT = 1
"""Changes with the tables and with the way keys and checksums are made."""
BUSY_SECONDS = 60.0
"""How long to wait for another process that writes."""

_DTYPE = "<f8"
_SCHEMA = """
CREATE TABLE responses (
    key BLOB NOT NULL UNIQUE,
    dtype TEXT NOT NULL,
    rows INTEGER NOT NULL,
    data BLOB NOT NULL,
    checksum BLOB NOT NULL
)
"""
_FAILURES = (sqlite3.Error, UnicodeDecodeError)
"""What SQLite raises; the second where the text of its error quotes a damaged file."""


def entry_key(identity: bytes, x: FloatArray) -> bytes:
    """Return the key of the responses of one model to the rows X (n, d)."""
    data = np.ascontiguousarray(x, dtype=_DTYPE)
    digest = hashlib.blake2b(key=identity, digest_size=16)
    digest.update(b"%d,%d:" % data.shape)
    digest.update(data.data if data.size else b"")
    return digest.digest()


class Store:
    """Model responses in one SQLite file.

    Several runs, threads and processes may use the same file at the same time; each process opens
    it for itself. While it is open SQLite keeps two more files beside it (``-wal``, ``-shm``). They
    belong to it and go away when it is closed; after a kill they are taken up by the next opening.
    The file must lie on a local disk, since SQLite cannot share one over a network.

    Parameters
    ----------
    path
        The file; it is made if there is none.

    Raises
    ------
    TypeError, ValueError
        If it is not a path, or one that SQLite would keep in memory (``:memory:``).
    StoreError
        If the file cannot be opened or made, is something else, was written in another format, or
        is damaged. No file that is not a store is changed.

    Examples
    --------
    >>> import tempfile, pathlib, uqfold
    >>> path = pathlib.Path(tempfile.mkdtemp(), "runs.db")
    >>> problem, method = uqfold.problems.series(), uqfold.methods.FFNISaddlepoint()
    >>> for _ in range(2):
    ...     with Store(path) as store:
    ...         result = method.estimate(problem, evaluator=uqfold.Evaluator(store=store))
    ...     print(result.n_evals, result[0].n_reused)
    241 0
    241 241
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = _checked_path(path)
        self._lock = threading.Lock()
        self._process = os.getpid()
        try:
            self._connection = sqlite3.connect(
                self.path, timeout=BUSY_SECONDS, isolation_level=None, check_same_thread=False
            )
        except _FAILURES as error:
            raise self._failure(error) from error
        try:
            self._prepare()
        except BaseException:
            self._connection.close()
            raise
        # a connection that is only dropped stays open until the garbage is collected
        self._close = weakref.finalize(self, _close_in, self._process, self._connection)

    def get(self, keys: Sequence[bytes], rows: Sequence[int]) -> list[FloatArray | None]:
        """Look up entries.

        Parameters
        ----------
        keys
            Keys from `entry_key`.
        rows
            How many responses each entry has to hold.

        Returns
        -------
        list[FloatArray | None]
            The responses of each, or None where there is no entry.

        Raises
        ------
        StoreError
            If the file cannot be read, or an entry is damaged.
        """
        found: list[FloatArray | None] = []
        query = "SELECT dtype, rows, data, checksum FROM responses WHERE key = ?"
        with self._lock:
            self._check_process()
            try:
                for key, n in zip(keys, rows, strict=True):
                    entry = self._connection.execute(query, (key,)).fetchone()
                    found.append(None if entry is None else self._checked(key, n, *entry))
            except _FAILURES as error:
                raise self._failure(error) from error
        return found

    def put(self, entries: Iterable[tuple[bytes, FloatArray]]) -> None:
        """Write entries (key, responses) in one transaction; they replace those of the same key.

        Raises
        ------
        StoreError
            If they cannot be written; none of them is then.
        """
        rows = []
        for key, y in entries:
            data = np.ascontiguousarray(y, dtype=_DTYPE).tobytes()
            rows.append((key, _DTYPE, y.size, data, _checksum(key, _DTYPE, y.size, data)))
        with self._lock:
            self._check_process()
            try:
                self._connection.execute("BEGIN IMMEDIATE")
                self._connection.executemany(
                    "INSERT OR REPLACE INTO responses VALUES (?, ?, ?, ?, ?)", rows
                )
                self._connection.execute("COMMIT")
            except BaseException as error:
                with suppress(sqlite3.Error):
                    self._connection.execute("ROLLBACK")
                if isinstance(error, _FAILURES):
                    raise self._failure(error) from error
                raise

    def __len__(self) -> int:
        """Return the number of responses kept, those of all models together."""
        with self._lock:
            self._check_process()
            try:
                (count,) = self._connection.execute("SELECT sum(rows) FROM responses").fetchone()
            except _FAILURES as error:
                raise self._failure(error) from error
        return int(count or 0)

    def __bool__(self) -> bool:
        """Whether there is a store: an empty one is one too."""
        return True

    def __repr__(self) -> str:
        return f"Store({str(self.path)!r})"

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._close()

    def __enter__(self) -> Store:
        """Return the store."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file."""
        self.close()

    def _prepare(self) -> None:
        """Recognise the file, or make an empty one a store."""
        try:
            if self._is_new():
                self._connection.execute("PRAGMA journal_mode = WAL")
                self._connection.execute("BEGIN IMMEDIATE")
                if self._is_new():
                    self._connection.execute(_SCHEMA)
                    self._connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
                    self._connection.execute(f"PRAGMA user_version = {FORMAT}")
                self._connection.execute("COMMIT")
            if self._pragma("application_id") != APPLICATION_ID:
                raise StoreError(f"{self.path} is a database, but not a store of uqfold")
            if self._pragma("user_version") != FORMAT:
                raise StoreError(
                    f"{self.path} is a store of format {self._pragma('user_version')}, this "
                    f"version of uqfold reads format {FORMAT}: give another path"
                )
            # a commit has to outlive a loss of power
            self._connection.execute("PRAGMA synchronous = FULL")
            self._connection.execute("SELECT key FROM responses LIMIT 1").fetchone()
        except _FAILURES as error:
            raise self._failure(error) from error

    def _is_new(self) -> bool:
        query = "SELECT count(*) FROM sqlite_master"
        (tables,) = self._connection.execute(query).fetchone()
        return tables == 0 and self._pragma("application_id") == 0

    def _pragma(self, name: str) -> int:
        (value,) = self._connection.execute(f"PRAGMA {name}").fetchone()
        return int(value)

    def _checked(self, key: bytes, n: int, *entry: object) -> FloatArray:
        match entry:
            case (str(dtype), int(rows), bytes(data), bytes(checksum)):
                sound = (dtype, rows, len(data)) == (_DTYPE, n, 8 * n)
                if sound and checksum == _checksum(key, dtype, rows, data):
                    return np.frombuffer(data, dtype=_DTYPE).astype(np.float64)
        raise StoreError(
            f"{self.path} is damaged: the entry {key.hex()} fails its checksum. Put back a copy "
            "of the file, or give another path"
        )

    def _check_process(self) -> None:
        if os.getpid() != self._process:
            raise StoreError(
                f"{self.path} was opened by another process: open it here with Store(path)"
            )

    def _failure(self, error: Exception) -> StoreError:
        damaged = "SQLITE_CORRUPT" if isinstance(error, UnicodeDecodeError) else ""
        name = getattr(error, "sqlite_errorname", damaged)
        changed = (
            "another program has changed it: put back a copy of the file, or give another path"
        )
        reason = {
            "SQLITE_NOTADB": "is not a store of uqfold, or a damaged one",
            "SQLITE_CORRUPT": "is damaged: put back a copy of the file, or give another path",
            "SQLITE_FULL": "cannot be written, the disk is full: what was committed is kept",
            "SQLITE_IOERR": "cannot be read or written: check the disk, its quota and the network",
            "SQLITE_CANTOPEN": "cannot be opened or made: check the folder and its permissions",
            "SQLITE_READONLY": "is read-only: check its permissions",
            "SQLITE_CONSTRAINT": f"takes no entries, {changed}",
            "SQLITE_ERROR": f"has other tables, {changed}",
            "SQLITE_BUSY": f"is locked by another process since {BUSY_SECONDS:.0f} s",
        }
        told = next((text for start, text in reason.items() if name.startswith(start)), "failed")
        return StoreError(f"the store {self.path} {told} ({error})")


def _checked_path(path: object) -> Path:
    """Return the path of a file that outlives the program."""
    given = checks.path("path", path)
    text = str(given).strip()
    if not text or Path(text).name == ":memory:" or text.startswith("file:"):
        remedy = "give the path of a file; a database in memory keeps nothing"
        raise checks.refused("path", text, remedy)
    return given


def _close_in(process: int, connection: sqlite3.Connection) -> None:
    # what a fork has inherited is not its own to close
    if os.getpid() == process:
        connection.close()


def _checksum(key: bytes, dtype: str, rows: int, data: bytes) -> bytes:
    digest = hashlib.blake2b(data, digest_size=8)
    digest.update(b"%b %b %d" % (key, dtype.encode(), rows))
    return digest.digest()
