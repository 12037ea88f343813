"""Running the model: counting, budget, failed runs, progress; store, executors, external codes."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
