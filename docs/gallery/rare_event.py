"""One in two million, in a hundred inputs.

A sum of a hundred normal inputs, whose failure probability is known: 2.9e-7. Line sampling finds
the one direction that matters; subset simulation needs none, and pays for it. Crude Monte Carlo
would take 300 million runs.
"""

import uqfold
from uqfold.inputs import normal

sum_of_many = uqfold.Problem(
    lambda x: x.sum(axis=1) / 10.0,
    individual={f"x{i}": normal(0, 1) for i in range(100)},
    name="sum",
)
methods = ["line-sampling", "importance-sampling", "subset-simulation"]
thresholds = uqfold.criteria([3.0, 4.0, 5.0])
known = {3.0: 1.3499e-3, 4.0: 3.1671e-5, 5.0: 2.8665e-7}
frame = uqfold.compare(sum_of_many, methods, thresholds, reference=known, rng=1)
figure = uqfold.plots.error_against_evaluations(frame)
print(frame[["label", "threshold", "pf", "error", "n_evals_row", "status"]].to_string(index=False))
