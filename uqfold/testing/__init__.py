"""The contract that every reliability method keeps, for authors of methods to run on their own.

>>> from uqfold.methods import FFNISaddlepoint
>>> from uqfold.testing import check_method
>>> check_method(FFNISaddlepoint(), only=["evaluations_are_counted_per_sample"])
['evaluations_are_counted_per_sample']
"""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
