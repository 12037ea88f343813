"""Validation cases: what is claimed, what was measured for it, and records of both.

A case is a folder (docs/validation.md). Reading a record runs no model, and imports nothing that
the record names.
"""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
