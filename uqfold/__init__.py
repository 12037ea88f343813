"""uqfold: how reliable is this system, and which method tells us most cheaply?

One model, its random inputs and a failure rule go in; several reliability methods answer the same
question; one table, with costs and error bars, says who was right.

>>> import uqfold
>>> problem = uqfold.problems.series()
>>> result = uqfold.methods.FFNISaddlepoint().estimate(problem, uqfold.criteria(threshold=2.0))
>>> result.n_evals, result[0].status
(205, 'converged')
"""

from uqfold.lazy import attach_stub

__version__ = "0.2.0"

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
