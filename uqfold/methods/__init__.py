"""Reliability methods behind one interface; `available()` lists them by name."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
