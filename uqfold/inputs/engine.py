"""OpenTURNS, imported where it is first needed, and kept from taking Ctrl-C over.

While any of its functions runs, OpenTURNS has a handler of its own for Ctrl-C in the whole process
(https://github.com/openturns/openturns/issues/3135). It throws a C++ exception in whatever thread
the system hands the signal to: an error like any other at best, often the end of the process. To
block the signal around the call only passes it on to another thread, such as those of the linear
algebra, where the exception is always the end.

So OpenTURNS' extension modules are made to call a function that does nothing where they call
`signal`: in each module, the entry of the dynamic linker's table that stands for that name is
overwritten once. That is possible where modules are ELF files (Linux); elsewhere Python's handler
is at least put back whenever OpenTURNS calls one of our functions.
"""

from __future__ import annotations

import ctypes
import mmap
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from uqfold.inputs.interrupts import reclaim_interrupt

_SEGMENT = np.dtype("u4, u4, u8, u8, u8, u8, u8, u8")
_SEGMENT.names = ("kind", "flags", "offset", "at", "physical", "in_file", "size", "align")
_TAG = np.dtype([("tag", "i8"), ("value", "u8")])
_RELOCATION = np.dtype([("offset", "u8"), ("info", "u8"), ("addend", "i8")])
_SYMBOL = np.dtype([("name", "u4"), ("rest", "u4"), ("value", "u8"), ("size", "u8")])
_DYNAMIC, _READ_ONLY = 2, 0x6474E552
_STRINGS, _SYMBOLS, _STRINGS_SIZE, _END = 5, 6, 10, 0
_RELOCATIONS = ((23, 2), (7, 8))
"""Kinds of segments and entries by the ELF standard (System V ABI, chapters 4 and 5)."""

_lock = threading.Lock()
_kept_out = False


def openturns() -> Any:
    """Return the module `openturns`, which from then on leaves Ctrl-C to Python."""
    global _kept_out  # noqa: PLW0603
    import openturns as module

    if not _kept_out:
        with _lock:
            if not _kept_out and sys.platform == "linux" and sys.maxsize > 2**32:
                _keep_out(Path(module.__file__ or "").parent)
                reclaim_interrupt()  # it may be running, and cannot put it back any more
            _kept_out = True
    return module


def _keep_out(folder: Path) -> None:
    """Let the extension modules in a folder call `abs` instead of `signal`."""
    does_nothing = ctypes.cast(ctypes.CDLL(None).abs, ctypes.c_void_p).value
    for base, segments in _loaded(str(folder) + "/_"):
        locked = segments[segments["kind"] == _READ_ONLY]
        for entry in _entries(base, segments, b"signal"):
            at = entry - base
            inside = (locked["at"] <= at) & (at < locked["at"] + locked["size"])
            if inside.any():
                _protect(entry, writable=True)
            ctypes.c_void_p.from_address(entry).value = does_nothing
            if inside.any():
                _protect(entry, writable=False)


class _Loaded(ctypes.Structure):
    """The beginning of `struct dl_phdr_info`."""

    _fields_ = (
        ("base", ctypes.c_size_t),
        ("name", ctypes.c_char_p),
        ("segments", ctypes.c_void_p),
        ("count", ctypes.c_uint16),
    )


def _loaded(start: str) -> list[tuple[int, npt.NDArray[Any]]]:
    """Return base address and segments of the shared objects whose path starts so."""
    found = []
    kind = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(_Loaded), ctypes.c_size_t, ctypes.c_void_p)

    def note(info: Any, _: int, __: Any) -> int:
        one = info.contents
        if (one.name or b"").decode(errors="replace").startswith(start):
            found.append((one.base, _table(one.segments, one.count, _SEGMENT)))
        return 0

    ctypes.CDLL(None).dl_iterate_phdr(kind(note), None)
    return found


def _entries(base: int, segments: npt.NDArray[Any], name: bytes) -> list[int]:
    """Addresses of the table entries that stand for an imported name."""
    [dynamic] = segments[segments["kind"] == _DYNAMIC]
    tags = _table(base + int(dynamic["at"]), int(dynamic["size"]) // _TAG.itemsize, _TAG)
    known = dict(tags[: int(np.argmax(tags["tag"] == _END))].tolist())

    def address(tag: int) -> int:
        """Address in memory; not every linker has added the base."""
        value = int(known[tag])
        return value if value >= base else base + value

    strings = ctypes.string_at(address(_STRINGS), known[_STRINGS_SIZE])
    places, at = [], strings.find(name + b"\0")
    while at >= 0:
        places.append(at)
        at = strings.find(name + b"\0", at + 1)
    found = []
    for table, size in _RELOCATIONS:
        if table not in known:
            continue
        count = known[size] // _RELOCATION.itemsize
        relocations = _table(address(table), count, _RELOCATION)
        symbol = (relocations["info"] >> np.uint64(32)).astype(np.intp)
        names = _table(address(_SYMBOLS), int(symbol.max(initial=0)) + 1, _SYMBOL)["name"]
        ours = (symbol > 0) & np.isin(names[symbol], places)
        found += [base + int(offset) for offset in relocations["offset"][ours]]
    return found


def _table(address: int, count: int, kind: np.dtype[Any]) -> npt.NDArray[Any]:
    memory = (ctypes.c_ubyte * (count * kind.itemsize)).from_address(address)
    return np.asarray(memory).view(kind)


def _protect(address: int, *, writable: bool) -> None:
    page = address - address % mmap.PAGESIZE
    modes = mmap.PROT_READ | (mmap.PROT_WRITE if writable else 0)
    protect = ctypes.CDLL(None, use_errno=True).mprotect
    protect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]
    if protect(page, mmap.PAGESIZE, modes) != 0:
        raise OSError(ctypes.get_errno(), "mprotect")
