"""Figures of comparisons, results and analyses: matplotlib, and nothing else draws.

Functions take a frame, a result or the table of an analysis, and return matplotlib axes, or a
figure where several panels are the point. Nothing here runs a model or knows a window.
"""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
