"""What every command knows of the process that it runs in, and how it refuses bad words."""

from __future__ import annotations

import json
import signal
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import FrameType
from typing import Annotated, Any, TypeVar

import typer

from uqfold.cli.streams import os_error_text
from uqfold.evaluation.errors import EngineError

Value = TypeVar("Value")
Words = list[str] | None


class Interrupts:
    """While entered, Ctrl-C is answered as before, and remembered.

    Attributes
    ----------
    requested
        Whether Ctrl-C was pressed; a library may have swallowed the exception since.
    """

    def __init__(self) -> None:
        self.requested = False
        self._answer: Any = None

    def __enter__(self) -> Interrupts:
        """Take the signal over, unless it is ignored."""
        handler = signal.getsignal(signal.SIGINT)
        if threading.current_thread() is threading.main_thread() and callable(handler):
            self._answer = handler
            signal.signal(signal.SIGINT, self._remember)
        return self

    def __exit__(self, *error: object) -> None:
        """Put the former handler of the signal back."""
        if self._answer is not None:
            signal.signal(signal.SIGINT, self._answer)

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C was pressed at any time before."""
        if self.requested:
            raise KeyboardInterrupt

    def _remember(self, number: int, frame: FrameType | None) -> None:
        self.requested = True
        self._answer(number, frame)


@dataclass(frozen=True)
class Invocation:
    """What a command knows of the process: the words typed, and Ctrl-C."""

    words: Sequence[str]
    interrupts: Interrupts


def option(metavar: str | None, text: str) -> Any:
    """Return an option that takes a value; its choices stand for a `metavar` of None."""
    return typer.Option(metavar=metavar, help=text)


def flag(name: str, text: str) -> Any:
    """Return an option that is given or not."""
    return typer.Option(name, help=text)


AsJson = Annotated[bool, flag("--json", "Print JSON, for programs.")]


def say_json(value: object) -> None:
    """Print a value as JSON."""
    typer.echo(json.dumps(value, indent=1, ensure_ascii=False, default=str))


def usage(check: Callable[..., Value], *arguments: object) -> Value:
    """Turn what a check has against the user's words into a usage error."""
    try:
        return check(*arguments)
    except (ValueError, EngineError) as error:
        raise typer.BadParameter(str(error)) from error
    except OSError as error:
        raise typer.BadParameter(os_error_text(error)) from error
