"""Expressions of unit names: how the text of a `Structure` is read.

Lines ``name = expression`` name a part, for the lines below them; the last line is the system. A
part that stands in several places, as the gates of fault trees do, is so written and kept once.
Nothing here calls itself, so that parts may stand as deep within each other as they like.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TypeAlias

Term: TypeAlias = int | str
"""A gate by its number, or a unit by its name."""

_TOKEN = re.compile(r"\w+|\\\n|[^\S\n]+|.|\n")
_STRENGTH = {"&": 4, "|": 3, "and": 2, "or": 1}
"""How tightly a sign binds."""


@dataclass(frozen=True)
class Gate:
    """Works when at least `k` of its parts work."""

    k: int
    parts: tuple[Term, ...]


@dataclass(frozen=True, eq=False)
class Expression:
    """What the lines of a text say.

    Attributes
    ----------
    gates
        Each after those that it uses.
    system
        What must work for the system to work.
    named
        The parts that have a name.
    """

    gates: tuple[Gate, ...]
    system: Term
    named: Mapping[str, Term] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """The units on which the system depends, each once, in order of appearance."""
        return self.order(units_first=False)

    def order(self, *, units_first: bool) -> tuple[str, ...]:
        """The same, or with the units of each gate before those of the gates within it."""
        waiting: list[Term] = [self.system]
        found: dict[str, None] = {}
        seen: set[int] = set()
        while waiting:
            part = waiting.pop()
            if isinstance(part, str):
                found[part] = None
            elif part not in seen:
                seen.add(part)
                parts = self.gates[part].parts
                if units_first:
                    found.update((one, None) for one in parts if isinstance(one, str))
                waiting.extend(reversed(parts))
        return tuple(found)


@lru_cache(maxsize=64)
def read(text: str) -> Expression:
    """Read the lines of a text.

    Raises
    ------
    ValueError
        If they are not expressions of names, or name a part twice or before its line.
    """
    if "#" in text:
        raise ValueError("no part may be a comment: leave out #")
    reader = _Reader()
    *lines, last = [*_lines(text)] or [[]]
    for line in lines:
        name, *rest = line
        if not _is_name(name) or rest[:1] != ["="]:
            raise ValueError(f"{' '.join(line)!r} names no part: write name = expression")
        part = reader.expression(rest[1:])
        if name in reader.named or name in reader.used:
            raise ValueError(f"{name!r} is named again, or after its use")
        reader.named[name] = part
    if not last or "=" in last:
        raise ValueError("its last line must say when the system works")
    system = reader.expression(last)
    if unused := reader.named.keys() - reader.used:
        raise ValueError(f"the part {min(unused)!r} is named and not used")
    return Expression(tuple(reader.gates), system, reader.named)


def _lines(text: str) -> Iterator[list[str]]:
    """Yield the words and signs of each line; within brackets a line goes on."""
    line: list[str] = []
    depth = 0
    for token in _TOKEN.findall(text):
        depth += (token == "(") - (token == ")")
        if token == ";" or (token == "\n" and depth <= 0):
            if line:
                yield line
            line = []
        elif not token.isspace() and token != "\\\n":
            line.append(token)
    if line:
        yield line


def _is_name(token: str) -> bool:
    return token.isidentifier() and not keyword.iskeyword(token)


@dataclass(frozen=True)
class _Open:
    """A sign or a bracket whose parts are being read."""

    sign: str
    k: int = 0
    parts: list[Term] = field(default_factory=list)


class _Reader:
    """Gates that were read so far."""

    def __init__(self) -> None:
        self.gates: list[Gate] = []
        self.named: dict[str, Term] = {}
        self.used: set[str] = set()

    def expression(self, tokens: Sequence[str]) -> Term:
        """Read an expression, and return what it stands for."""
        waiting: list[_Open] = []
        part: Term | None = None
        ahead = iter((*tokens, ""))
        for token in ahead:
            if token in _STRENGTH or token in {")", ",", ""}:
                if part is None:
                    raise ValueError(f"a name is missing {_before(token)}")
                part = self._after(part, token, waiting)
                continue
            if part is not None:
                raise ValueError(f"& or | is missing {_before(token)}")
            if token == "at_least":
                waiting.append(_counting(next(ahead), next(ahead, ""), next(ahead, "")))
            elif token == "(":
                waiting.append(_Open("("))
            elif _is_name(token):
                self.used.add(token)
                part = self.named.get(token, token)
            else:
                raise ValueError(f"{token!r} is no unit name")
        assert part is not None
        return part

    def _after(self, part: Term, token: str, waiting: list[_Open]) -> Term | None:
        """Put a part that ends before this token where it belongs; a part that is now whole."""
        strength = _STRENGTH.get(token, 0)
        while waiting and _STRENGTH.get(waiting[-1].sign, 0) > strength:
            part = self._closed(waiting.pop(), part)
        around = waiting[-1].sign if waiting else ""
        if strength:
            if around != token:
                waiting.append(_Open(token))
            waiting[-1].parts.append(part)
            return None
        if token == "," and around == "at_least":
            waiting[-1].parts.append(part)
            return None
        if token == ")" and around:
            return self._closed(waiting.pop(), part)
        if token or around:
            raise ValueError(f"{token!r} is out of place" if token else "a bracket is not closed")
        return part

    def _closed(self, one: _Open, last: Term) -> Term:
        """Return the gate of all its parts."""
        if one.sign == "(":
            return last
        parts = (*one.parts, last)
        k = {"at_least": one.k, "&": len(parts), "and": len(parts)}.get(one.sign, 1)
        if not 1 <= k <= len(parts):
            raise ValueError(f"at_least({k}, ...) counts {len(parts)} parts")
        self.gates.append(Gate(k, parts))
        return len(self.gates) - 1


def _counting(bracket: str, k: str, comma: str) -> _Open:
    if bracket != "(" or not k.isdecimal() or comma != ",":
        raise ValueError("at_least takes a number and the parts that it counts")
    return _Open("at_least", int(k))


def _before(token: str) -> str:
    return f"before {token!r}" if token else "at the end"
