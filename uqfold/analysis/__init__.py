"""Questions beyond a failure probability: what it answers to, and how to design for it."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
