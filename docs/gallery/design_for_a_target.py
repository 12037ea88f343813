"""A threshold for a target.

Which threshold is kept with a failure probability of 1e-3 over one, five and twenty missions? The
interval of pf on a Kriging surface becomes one of the threshold; its safe end is verified by
simulation of the real model.
"""

import uqfold
from uqfold.analysis import design_thresholds, designs_to_frame

profiles = [(None, 1), (None, 5), (None, 20)]
designs = design_thresholds(uqfold.problems.series(), 1e-3, (2.0, 8.0), profiles, rng=1)
simulation = uqfold.methods.ConditionalMonteCarlo(missions_per_draw=20)
table = designs_to_frame(designs, simulation, max_evals=400_000)
figure = uqfold.plots.design(table)
print(table[["missions", "value", "low", "high", "safe", "status"]].round(4).to_string(index=False))
