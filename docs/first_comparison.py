"""A first comparison: five methods on a model of one's own, with a reference."""

import uqfold
from uqfold.inputs import normal


def stress(x):  # one row for each sample, one column for each input
    load, width, height = x.T
    return load / (width * height**2)


beam = uqfold.Problem(
    stress,
    individual={"load": normal(10.0, 1.5), "width": normal(1.0, 0.05), "height": normal(2.0, 0.1)},
)
long_run = uqfold.methods.MonteCarlo(systems=1_000_000).estimate(beam, 4.5, rng=0)
methods = ["ffni-pearson", "kriging", "pce", "openturns-form", "importance-sampling"]
frame = uqfold.compare(beam, methods, 4.5, reference=long_run)
print(frame)
uqfold.plots.save(uqfold.plots.comparison(frame), "first-comparison")  # a PNG
