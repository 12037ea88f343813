"""Five methods on one model.

A beam's stress must stay below a threshold. `plots.comparison` draws the curve once, and below it
one row for each method: its answer as a share of the reference, with the interval that it states
itself.
"""

import uqfold
from uqfold.inputs import normal


def stress(x):
    load, width, height = x.T
    return load / (width * height**2)


beam = uqfold.Problem(
    stress,
    individual={"load": normal(10.0, 1.5), "width": normal(1.0, 0.05), "height": normal(2.0, 0.1)},
    response="stress",
)
thresholds = uqfold.criteria([3.0, 3.5, 4.0, 4.5])
long_run = uqfold.methods.MonteCarlo(systems=1_000_000).estimate(beam, thresholds, rng=0)
methods = ["ffni-pearson", "kriging", "pce", "sorm", "subset-simulation"]
frame = uqfold.compare(beam, methods, thresholds, reference=long_run, max_evals=20_000)
figure = uqfold.plots.comparison(frame)
