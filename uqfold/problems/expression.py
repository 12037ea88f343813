"""Expressions of unit names: how the text of a `Structure` is read.

Lines ``name = expression`` name a part, for the lines below them; the last line is the system. A
part that stands in several places, as the gates of fault trees do, is so written and kept once.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache


@dataclass(frozen=True, eq=False)
class Expression:
    """What the lines of a text say.

    Attributes
    ----------
    parts
        Named parts, each after those that it uses.
    system
        When the system works.
    """

    parts: Mapping[str, ast.expr]
    system: ast.expr

    @property
    def names(self) -> tuple[str, ...]:
        """The units on which the system depends, each once, in order of appearance."""
        return tuple(dict.fromkeys(self._names()))

    def _names(self) -> Iterator[str]:
        waiting, seen = [self.system], set()
        while waiting:
            node = waiting.pop()
            if not isinstance(node, ast.Name):
                waiting.extend(reversed(branches(node)[1]))
            elif node.id not in self.parts:
                yield node.id
            elif node.id not in seen:
                seen.add(node.id)
                waiting.append(self.parts[node.id])


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
    try:
        lines = ast.parse(inspect.cleandoc(text)).body
        parts: dict[str, ast.expr] = {}
        used: set[str] = set()
        for line in lines[:-1]:
            name, part = _named(line)
            used |= _checked(part)
            if name in parts or name in used:
                raise ValueError(f"{name!r} is named again, or after its use")
            parts[name] = part
        if not lines or not isinstance(lines[-1], ast.Expr):
            raise ValueError("its last line must say when the system works")
        found = Expression(parts, lines[-1].value)
        unused = parts.keys() - used - _checked(found.system)
        if unused:
            raise ValueError(f"the part {min(unused)!r} is named and not used")
    except (SyntaxError, RecursionError, MemoryError):
        raise ValueError("it cannot be read") from None
    return found


def branches(node: ast.expr) -> tuple[int, list[ast.expr]]:
    """Return how many of the parts of a node must work, and these parts.

    Raises
    ------
    ValueError
        If it joins no parts as the expression of a `Structure` may.
    """
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitAnd | ast.BitOr):
        parts, joint = [], type(node.op)
        while isinstance(node, ast.BinOp) and isinstance(node.op, joint):
            parts.append(node.right)
            node = node.left
        parts.append(node)
        return (len(parts) if joint is ast.BitAnd else 1), parts[::-1]
    if isinstance(node, ast.BoolOp):
        return (len(node.values) if isinstance(node.op, ast.And) else 1), node.values
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "at_least":
        if len(node.args) < 2 or node.keywords or not isinstance(node.args[0], ast.Constant):
            raise ValueError("at_least takes a number and the parts that it counts")
        k, *parts = node.args[0].value, *node.args[1:]
        if type(k) is not int or not 1 <= k <= len(parts):
            raise ValueError(f"at_least({k!r}, ...) counts {len(parts)} parts")
        return k, parts
    raise ValueError(f"{ast.unparse(node)!r} is no unit name")


def _named(line: ast.stmt) -> tuple[str, ast.expr]:
    """Return the name that a line gives, and to what."""
    if isinstance(line, ast.Assign) and len(line.targets) == 1:
        target = line.targets[0]
        if isinstance(target, ast.Name):
            return target.id, line.value
    raise ValueError(f"{ast.unparse(line)!r} names no part: write name = expression")


def _checked(node: ast.expr) -> set[str]:
    """Return all names in an expression, each part of which is well-formed."""
    waiting, found = [node], set()
    while waiting:
        one = waiting.pop()
        if isinstance(one, ast.Name):
            found.add(one.id)
        else:
            waiting.extend(branches(one)[1])
    return found
