"""Pages, tables on a terminal and progress: how results are told; nothing here runs a model."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
