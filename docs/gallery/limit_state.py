"""Where active Kriging looks.

The four-branch function of the literature fails beyond four branches (the line is the limit
state). Active Kriging spends its runs there; a space-filling design does not know where that is.
"""

from dataclasses import replace

import numpy as np
import pandas as pd

import uqfold

problem = uqfold.problems.four_branch()
rows = []
for name in ("active-kriging", "kriging"):

    def recorded(x, name=name):
        rows.extend({"series": name, "x": one, "y": two} for one, two in x)
        return problem.model(x)

    watched = replace(problem, model=recorded)
    print(uqfold.methods.build(name).estimate(watched, rng=1))
axes = uqfold.plots.points(pd.DataFrame(rows), "x1", "x2")
grid = np.linspace(-8.0, 8.0, 200)
x1, x2 = np.meshgrid(grid, grid)
response = problem.model(np.column_stack([x1.ravel(), x2.ravel()])).reshape(x1.shape)
axes.contour(x1, x2, response, levels=[0.0], colors="black", linewidths=1.0)
axes.set_aspect("equal")
figure = axes.figure
