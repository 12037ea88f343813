"""A common cause undoes redundancy.

Four units of which one has to work. The more of the response's variance comes from what the units
share, the less the spare ones are worth; in series it is the other way round. FORM answers each
system with one unit's design point.
"""

import pandas as pd

import uqfold
from uqfold.inputs import normal

form = uqfold.methods.OpenTURNSFORM()
structures = {"series": uqfold.Series(), "2 of 4": uqfold.KOutOfN(2), "parallel": uqfold.Parallel()}
rows = []
for share in (0.02, 0.1, 0.2, 0.4, 0.6, 0.8, 0.95):

    def response(x, share=share):
        return share**0.5 * x[:, 0] + (1.0 - share) ** 0.5 * x[:, 1]

    for name, structure in structures.items():
        system = uqfold.Problem(
            response,
            shared={"cause": normal(0, 1)},
            individual={"own": normal(0, 1)},
            units=4,
            structure=structure,
        )
        pf = form.estimate(system, uqfold.Criterion(2.5))[0].pf
        rows.append({"series": name, "x": share, "y": pf})
figure = uqfold.plots.points(
    pd.DataFrame(rows), "share of the variance from the common cause", "pf", log="y"
)
