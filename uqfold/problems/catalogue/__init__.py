"""Limit states of the literature, each with its source and a failure probability of our own."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
