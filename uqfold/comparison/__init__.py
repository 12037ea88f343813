"""Several methods, one problem, one grid of criteria: run them, keep the records."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
