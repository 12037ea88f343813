"""Random inputs: distributions of any origin, brought into one ordered joint distribution."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
