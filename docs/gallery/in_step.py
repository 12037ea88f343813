"""Units that must respond in step.

Four units have to respond in time and within tau of each other. With a large tau the threshold T
decides; with a small one reliability climbs to a plateau below one. One design of a hundred runs
answers the whole grid.
"""

import numpy as np

import uqfold

problem = uqfold.problems.series()
grid = uqfold.criteria(np.linspace(-4.0, 6.0, 41), tau=[12.0, 16.0, 20.0], missions=[1, 5, 10])
result = uqfold.methods.FFNIPearson(check=False).estimate(problem, grid)
figure = uqfold.plots.reliability_panels(result, ["reliability"], curves="missions", panels="tau")
