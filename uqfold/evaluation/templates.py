"""Texts with placeholders ``{{name}}`` or ``{{name:format}}``, to be filled with numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath

from uqfold.checks import names, path, refused
from uqfold.evaluation.run_folder import REASON, STDERR, STDOUT, file_inside

_PLACEHOLDER = re.compile(r"\{\{\s*(\w+)\s*(?::([^{}]*))?\}\}")
_WIDE = re.compile(r"\d{4}")
_OURS = (STDOUT, STDERR, REASON)


def input_names(name: str, value: object) -> tuple[str, ...]:
    """Return the names of inputs: each once, of letters, digits and underscores.

    Raises
    ------
    TypeError, ValueError
        If one is not such a name, there is none, or one comes twice.
    """
    given = names(name, value)
    if not given:
        raise refused(name, given, "give at least one name")
    for i, one in enumerate(given):
        if re.fullmatch(r"\w+", one) is None:
            raise refused(f"{name}[{i}]", one, "give letters, digits and underscores only")
    return given


def template_texts(name: str, value: object) -> dict[str, str]:
    """Return file in the run's folder -> text of its template, read now.

    Bytes that are not UTF-8 are kept as surrogates, and line ends as they are, so that
    `write_filled` returns every byte that is not a placeholder.

    Raises
    ------
    TypeError, ValueError
        If a file does not lie inside the run's folder, two are the same, or one is not ours to
        give.
    OSError
        If a template cannot be read.
    """
    if not isinstance(value, Mapping):
        raise refused(name, value, "give a mapping of files to templates", TypeError)
    found: dict[str, str] = {}
    for key, source in value.items():
        file = file_inside(f"a file of {name}", key)
        if file.casefold() in _OURS:
            raise refused(f"a file of {name}", key, f"give another name than {', '.join(_OURS)}")
        if file in found:
            raise refused(f"a file of {name}", key, "give each file one template")
        content = path(f"{name}[{key!r}]", source).read_bytes()
        found[file] = content.decode("utf-8", "surrogateescape")
    folders = {parent.as_posix() for file in found for parent in PurePosixPath(file).parents}
    if both := folders & found.keys():
        raise refused(name, min(both), "give a name that is not a folder of another file too")
    return found


def check_placeholders(texts: Sequence[str], inputs: Sequence[str]) -> None:
    """Refuse placeholders that are not inputs or have no format, and inputs that occur nowhere.

    Raises
    ------
    ValueError
        Naming the first of them.
    """
    found = [match for text in texts for match in _PLACEHOLDER.finditer(text)]
    used = {match[1] for match in found}
    if unknown := used - set(inputs):
        raise ValueError(
            f"the placeholder {{{{{min(unknown)}}}}} is not an input: "
            f"choose from {', '.join(inputs)}"
        )
    for match in found:
        try:
            sound = _WIDE.search(match[2] or "") is None and _value(match, 0.5)
        except ValueError:
            sound = False
        if not sound:
            raise ValueError(
                f"the placeholder {match[0]} has no format for a number: give one as in "
                f"{{{{{match[1]}:12.5e}}}}"
            )
    if missing := [name for name in inputs if name not in used]:
        raise ValueError(
            f"the input {missing[0]!r} occurs nowhere: put {{{{{missing[0]}}}}} into a "
            "template or the command"
        )


def filled(text: str, values: Mapping[str, float]) -> str:
    """Return the text with its placeholders replaced by numbers."""
    return _PLACEHOLDER.sub(lambda match: _value(match, values[match[1]]), text)


def write_filled(folder: Path, texts: Mapping[str, str], values: Mapping[str, float]) -> None:
    """Write the files of a run into its empty folder."""
    for name, text in texts.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        # "x": two names may be one file where capitals do not count
        with target.open("xb") as stream:
            stream.write(filled(text, values).encode("utf-8", "surrogateescape"))


def _value(match: re.Match[str], number: float) -> str:
    # repr reads back to the same bits
    return repr(number) if match[2] is None else format(number, match[2])
