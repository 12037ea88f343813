"""What every command knows of the process that it runs in, and how it refuses bad words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import typer

from uqfold.cli.interrupts import Interrupts
from uqfold.cli.streams import os_error_text
from uqfold.evaluation.errors import EngineError

Value = TypeVar("Value")


@dataclass(frozen=True)
class Invocation:
    """What a command knows of the process: the words typed, and Ctrl-C."""

    words: Sequence[str]
    interrupts: Interrupts


def option(metavar: str, text: str) -> Any:
    """Return an option that takes a value."""
    return typer.Option(metavar=metavar, help=text)


def flag(name: str, text: str) -> Any:
    """Return an option that is given or not."""
    return typer.Option(name, help=text)


def usage(check: Callable[..., Value], *arguments: object) -> Value:
    """Turn what a check has against the user's words into a usage error."""
    try:
        return check(*arguments)
    except (ValueError, EngineError) as error:
        raise typer.BadParameter(str(error)) from error
    except OSError as error:
        raise typer.BadParameter(os_error_text(error)) from error
