"""Writing a page to a file."""

from __future__ import annotations

import glob
import os
from pathlib import Path
from typing import Literal, TypeAlias, get_args

from uqfold.report.page.blocks import Page
from uqfold.report.page.builder import Page as BuiltPage
from uqfold.writing import write_text

Format: TypeAlias = Literal["html", "md"]


def page_format(path: str | os.PathLike[str], given: str | None = None) -> Format:
    """Give the format of a page: the one asked for, or that of the file's suffix.

    Raises
    ------
    ValueError
        If it is neither ``html`` nor ``md``.
    """
    asked = Path(path).suffix.lower().lstrip(".") if given is None else given
    for known in get_args(Format):
        if asked == known:
            return known  # type: ignore[no-any-return]
    raise ValueError(f"format {asked!r}: choose from {', '.join(get_args(Format))}")


def write_page(
    page: Page | BuiltPage, path: str | os.PathLike[str], format: str | None = None
) -> list[Path]:
    """Write a page as HTML or Markdown; each file appears whole or not at all.

    Parameters
    ----------
    page
        The page.
    path
        Where to; its folder is made if it is missing.
    format
        ``html`` or ``md``; None: as the suffix says.

    Returns
    -------
    list[pathlib.Path]
        The file, and behind it the pictures that Markdown needs beside it.
    """
    if isinstance(page, BuiltPage):
        return page.write(path, format=format)
    file = Path(path)
    if page_format(file, format) == "html":
        from uqfold.report.page.html import page_html

        texts = {file.name: page_html(page)}
    else:
        from uqfold.report.page.markdown import page_markdown

        texts = page_markdown(page, file.stem)
        texts = {file.name: texts.pop(""), **texts}
    # pictures of an earlier report would not belong to this one
    for old in file.parent.glob(f"{glob.escape(file.stem)}-figures/[0-9][0-9]*.svg"):
        old.unlink()
    written = []
    for name, text in texts.items():
        target = file.parent / name
        target.parent.mkdir(parents=True, exist_ok=True)
        write_text(target, text)
        written.append(target)
    return written
