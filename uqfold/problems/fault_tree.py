"""Fault trees in the Open-PSA Model Exchange Format, read as the text of a `Structure`.

A fault tree says when the system fails, a structure when it works: "and" becomes "or", and "k of n
fail" becomes "n - k + 1 of n work" (De Morgan). Each gate becomes a line, so that gates and events
that are used several times stay what they are.

References
----------
Epstein S, Rauzy A. Open-PSA Model Exchange Format, version 2.0 (2008).
"""

from __future__ import annotations

import keyword
import os
import re
import unicodedata
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias
from xml.etree import ElementTree as ET

from uqfold import checks

MOST_BYTES = 64 << 20
"""A larger file is refused."""

Key: TypeAlias = tuple[str, str]
"""Kind, ``gate`` or ``basic-event``, and full name."""
Works: TypeAlias = str | bool
"""When a formula works: text, or what is certain."""

_WORD = re.compile(r"\w+")
_NESTED = ("define-fault-tree", "define-component")
_OPERATORS = ("and", "or", "atleast")
_SAID = ("label", "attributes")
_EVENTS = ("event", "gate", "basic-event", "house-event")


def read_open_psa(path: str | os.PathLike[str], top: str | None = None) -> str:
    """Return the expression of unit names of a fault tree, as `Structure.from_open_psa` takes it.

    Raises
    ------
    ValueError, OSError
        As said there.
    """
    file = checks.path("path", path)
    root = _parsed(file)
    reader = _Reader(_definitions(root))
    if any(True for _ in root.iter("define-CCF-group")):
        warnings.warn(
            f"{file.name}: groups of common-cause failures are not read; give what units share as "
            "shared= of the problem",
            UserWarning,
            stacklevel=3,
        )
    return reader.text(_top(reader, top))


@dataclass(frozen=True)
class _Defined:
    """A gate or event that the file defines, and the fault tree and components around it."""

    kind: str
    element: ET.Element
    scope: tuple[str, ...]


def _parsed(file: Path) -> ET.Element:
    data = file.read_bytes() if file.stat().st_size <= MOST_BYTES else b""
    if not data:
        raise checks.refused("path", str(file), f"give a file of 1 to {MOST_BYTES:,} bytes")
    if b"<!ENTITY" in data:
        raise checks.refused("path", str(file), "it defines entities: write them out")
    try:
        root = ET.fromstring(data)
    except (ET.ParseError, LookupError, ValueError) as error:
        raise checks.refused("path", str(file), f"no XML: {checks.said_by(error)}") from None
    if root.tag != "opsa-mef":
        remedy = f"its root is <{root.tag}>, not <opsa-mef>"
        raise checks.refused("path", str(file), remedy)
    return root


def _definitions(root: ET.Element) -> dict[str, _Defined]:
    """Return what is defined, by its full name."""
    found: dict[str, _Defined] = {}
    waiting: list[tuple[ET.Element, tuple[str, ...]]] = [(root, ())]
    while waiting:
        element, scope = waiting.pop()
        for one in element:
            if one.tag in _NESTED:
                waiting.append((one, (*scope, _attribute(one, "name"))))
            elif one.tag == "model-data":
                waiting.append((one, scope))
            elif one.tag.removeprefix("define-") in _EVENTS:
                name = ".".join((*scope, _attribute(one, "name")))
                if name in found:
                    raise ValueError(f"{name!r} is defined twice")
                found[name] = _Defined(one.tag.removeprefix("define-"), one, scope)
    return found


def _top(reader: _Reader, top: str | None) -> str:
    """Return the full name of the gate that is meant."""
    gates = [name for name, one in reader.defined.items() if one.kind == "gate"]
    if top is not None:
        try:
            return reader.meant(checks.text("top", top), "gate", ())[1]
        except ValueError as error:
            raise checks.refused("top", top, str(error)) from None
    used = {key for gate in gates for key in reader.used(gate)}
    tops = [name for name in gates if ("gate", name) not in used]
    if len(tops) != 1:
        found = f"{len(tops)} gates are used by no other ({_few(tops)})" if gates else "it has none"
        if gates and not tops:
            found = "each gate is used by another one, so that some are used within themselves"
        raise checks.refused("top", top, f"give the gate that is the system's failure; {found}")
    return tops[0]


class _Reader:
    """Formulas of gates, turned into lines."""

    def __init__(self, defined: Mapping[str, _Defined]) -> None:
        self.defined = defined
        self.by_last: dict[str, list[str]] = {}
        for name in defined:
            self.by_last.setdefault(name.rpartition(".")[2], []).append(name)
        self.texts: dict[Key, str] = {}
        self.taken: dict[str, Key] = {}

    def text(self, top: str) -> str:
        """Return the lines of a gate and of all that it uses, which come first."""
        order = self._order(top)
        for name in order:
            for kind, event in self.used(name):
                if kind == "basic-event":
                    self._name(kind, event)
        known: dict[str, Works] = {}
        parts: dict[str, str] = {}
        for name in order:
            gate = self.defined[name]
            works = self._works(_formula(gate.element), gate.scope, known)
            if isinstance(works, str) and name != top and not works.isidentifier():
                parts[self._name("gate", name)] = works
                works = self._name("gate", name)
            known[name] = works
        found = known[top]
        if found is True or found is False:
            raise ValueError(f"gate {top!r} {'never' if found else 'always'} fails")
        lines, wanted = [found], set(_WORD.findall(found))
        for name, part in reversed(parts.items()):
            # a house event may have made certain what a gate was for
            if name in wanted:
                lines.append(f"{name} = {part}")
                wanted.update(_WORD.findall(part))
        return "\n".join(reversed(lines))

    def _order(self, top: str) -> list[str]:
        """Return a gate after all that it uses, these too, without recursion."""
        done: dict[str, None] = {}
        waiting, begun = [top], set()
        while waiting:
            name = waiting[-1]
            below = [one for kind, one in self.used(name) if kind == "gate" and one not in done]
            if name in done or not below:
                done[waiting.pop()] = None
            elif name in begun:
                raise ValueError(f"gate {name!r} is used within itself")
            else:
                begun.add(name)
                waiting.extend(reversed(below))
        return list(done)

    def meant(self, name: str, kind: str, scope: tuple[str, ...]) -> Key:
        """Return what a name means there: in its own component first, then further out."""
        places = [".".join((*scope[:depth], name)) for depth in range(len(scope), -1, -1)]
        if not any(place in self.defined for place in places):
            places = self.by_last.get(name, [])
        fitting = [one for one in places if one in self.defined and self._fits(one, kind)]
        if len(fitting) > 1 and fitting == self.by_last.get(name):
            raise ValueError(f"{kind} {name!r} is one of several: {_few(fitting)}")
        if fitting:
            return self.defined[fitting[0]].kind, fitting[0]
        if kind in ("gate", "house-event"):
            raise ValueError(f"{kind} {name!r} is not defined; there are {_few(self.defined)}")
        return "basic-event", name

    def _fits(self, name: str, kind: str) -> bool:
        return kind in ("event", self.defined[name].kind)

    def used(self, name: str) -> list[Key]:
        """What the formula of a gate names."""
        gate = self.defined[name]
        events = [one for one in _formula(gate.element).iter() if one.tag in _EVENTS]
        return [self.meant(_attribute(one, "name"), _kind(one), gate.scope) for one in events]

    def _works(self, formula: ET.Element, scope: tuple[str, ...], known: dict[str, Works]) -> Works:
        """When it works that this formula does not hold, without recursion."""
        order = [formula]
        for one in order:
            if one.tag in _OPERATORS:
                order.extend(_parts(one))
        found: dict[ET.Element, Works] = {}
        for one in reversed(order):
            if one.tag in _OPERATORS:
                found[one] = _gate(one, [found[part] for part in _parts(one)])
            else:
                found[one] = self._event(one, scope, known)
        return found[formula]

    def _event(self, event: ET.Element, scope: tuple[str, ...], known: dict[str, Works]) -> Works:
        if event.tag == "constant":
            return not _truth(event)
        if event.tag not in _EVENTS:
            raise ValueError(f"<{event.tag}> is not monotone, or is unknown; know: and or atleast")
        kind, name = self.meant(_attribute(event, "name"), _kind(event), scope)
        if kind == "gate":
            return known[name]
        if kind == "house-event":
            value = self.defined[name].element.find("constant")
            return value is None or not _truth(value)
        return self._name(kind, name)

    def _name(self, kind: str, name: str) -> str:
        """Return the name of a gate or event as an identifier, another one for each."""
        if (kind, name) not in self.texts:
            last = name.rpartition(".")[2]
            short = last if len(self.by_last.get(last, [])) < 2 else name
            # as Python reads it: another sign for the same letter is the same name
            plain = unicodedata.normalize("NFKC", re.sub(r"\W", "_", short))
            if not plain.isidentifier() or keyword.iskeyword(plain) or plain == "at_least":
                plain = f"_{plain}"
            while kind == "gate" and plain in self.taken:
                plain += "_"
            if plain in self.taken:
                other = self.taken[plain]
                raise ValueError(
                    f"{kind} {name!r} and {' '.join(other)!r} are both read as {plain}"
                )
            self.taken[plain] = kind, name
            self.texts[kind, name] = plain
        return self.texts[kind, name]


def _parts(formula: ET.Element) -> list[ET.Element]:
    return [one for one in formula if one.tag not in _SAID]


def _gate(formula: ET.Element, parts: list[Works]) -> Works:
    """When it works that the formula of these parts does not hold."""
    fails = {"and": len(parts), "or": 1}.get(formula.tag) or _least(formula)
    if not 1 <= fails <= len(parts):
        raise ValueError(f"<{formula.tag}> asks for {fails} of {len(parts)} parts")
    return _at_least(len(parts) - fails + 1, parts)


def _at_least(k: int, parts: list[Works]) -> Works:
    """When at least k of the parts work."""
    k -= parts.count(True)
    rest = [one for one in parts if isinstance(one, str)]
    if k <= 0 or k > len(rest):
        return k <= 0
    if len(rest) == 1:
        return rest[0]
    if k in (1, len(rest)):
        return (" | " if k == 1 else " & ").join(
            one if one.isidentifier() else f"({one})" for one in rest
        )
    return f"at_least({k}, {', '.join(rest)})"


def _attribute(element: ET.Element, name: str) -> str:
    value = element.get(name, "").strip()
    if not value:
        raise ValueError(f"<{element.tag}> has no {name}")
    return value


def _kind(element: ET.Element) -> str:
    return element.get("type", element.tag) if element.tag == "event" else element.tag


def _truth(constant: ET.Element) -> bool:
    return checks.choice("constant", _attribute(constant, "value"), ("true", "false")) == "true"


def _least(formula: ET.Element) -> int:
    said = _attribute(formula, "min")
    if not said.isdecimal():
        raise ValueError(f"<{formula.tag}> has min = {said!r}: give a whole number")
    return int(said)


def _formula(gate: ET.Element) -> ET.Element:
    """Return the formula of a gate."""
    formulas = _parts(gate)
    if len(formulas) != 1:
        raise ValueError(f"gate {_attribute(gate, 'name')!r} has {len(formulas)} formulas, not one")
    return formulas[0]


def _few(names: Iterable[str]) -> str:
    shown = sorted(names)
    return ", ".join(shown[:10]) + (f" and {len(shown) - 10} others" if len(shown) > 10 else "")
