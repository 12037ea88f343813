"""The command line.

Everything heavy is imported when a command needs it, so that help appears at once.
"""

from uqfold.cli.app import main

__all__ = ["main"]
