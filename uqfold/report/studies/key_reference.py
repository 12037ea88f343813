"""The reference of all keys of a study file, in Markdown, made from what reads the file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from uqfold.comparison.studies.builtin import BUILT_IN
from uqfold.comparison.studies.keys import REQUIRED, Key, Kind
from uqfold.comparison.studies.problems import PROBLEM_KEYS
from uqfold.comparison.studies.registry import step_kinds
from uqfold.comparison.studies.study import (
    ANALYSIS_KEYS,
    CHECK_KEYS,
    EXHIBIT_KEYS,
    METHOD_KEYS,
    RUN_COLUMNS,
    RUN_KEYS,
    STUDY_KEYS,
)
from uqfold.report.studies.registry import figure_kinds, table_kinds

BEGIN = "<!-- keys: written by `uqfold study keys` -->"
END = "<!-- end of keys -->"


def key_reference() -> str:
    """Give the reference, between its two marks."""
    blocks = [
        BEGIN,
        "### The file",
        _table(STUDY_KEYS),
        "### `[problems.NAME]`",
        _table(PROBLEM_KEYS),
        "### `[methods.LABEL]`",
        _table(METHOD_KEYS),
        "### `[check]`",
        _table(CHECK_KEYS),
        "### `[[run]]`",
        _table(RUN_KEYS),
        "Columns of its table: " + _columns(RUN_COLUMNS),
        "### `[[analysis]]`",
        _table(ANALYSIS_KEYS),
        *_kinds(step_kinds().values(), "analysis"),
        "### `[[table]]` and `[[figure]]`",
        _table(EXHIBIT_KEYS),
        *_kinds(table_kinds().values(), "table"),
        *_kinds(figure_kinds().values(), "figure"),
        "### Tables that every study has",
        "\n".join(f"- `{name}`: {_columns(columns)}" for name, columns in BUILT_IN.items()),
        END,
    ]
    return "\n\n".join(blocks) + "\n"


def _kinds(kinds: Iterable[Kind], sort: str) -> Iterator[str]:
    for kind in kinds:
        yield f"#### {sort} kind `{kind.name}`"
        yield kind.meaning
        yield _table(kind.keys)
        if kind.columns:
            yield "Columns of its table: " + _columns(kind.columns)


def _table(keys: Sequence[Key]) -> str:
    lines = ["| key | holds | default | meaning |", "| --- | --- | --- | --- |"]
    lines += [
        f"| `{key.name}` | {key.value.text} | {_default(key)} | {key.meaning} |" for key in keys
    ]
    return "\n".join(lines)


def _default(key: Key) -> str:
    if key.default is REQUIRED:
        return "(required)"
    if key.default is None or key.default in ("", {}, ()):
        return ""
    shown = key.default
    if isinstance(shown, tuple):
        words = ["none" if one is None else str(one) for one in shown]
        return "`" + ", ".join(words) + "`" if words != ["none"] else "none"
    return f"`{str(shown).lower() if isinstance(shown, bool) else shown}`"


def _columns(columns: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in columns)
