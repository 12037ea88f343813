"""Problems: what may fail. The paper's examples, and the record to state others."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
