"""What methods state of themselves whose error is the spread of independent repetitions."""

from uqfold.methods.theory import Equation, Theory

QUASI_MONTE_CARLO = Theory(
    summary=(
        "Randomised quasi-Monte Carlo on the system itself. All random numbers of a system, its "
        "shared inputs, the individual inputs of every unit and mission and the number of "
        "missions, are the coordinates of a point in the unit cube; the points are those of a "
        "Sobol' sequence, scrambled. Each scrambling gives an estimate without bias. Several "
        "independent ones tell the error, whose interval is that of Student's t."
    ),
    equations=(
        Equation(
            "R scramblings of the first n = 2^k points give, with Φ⁻¹ for every coordinate",
            r"\hat{p}_r = \frac{1}{n} \sum_{i=1}^{n} \mathbf{1}_F\left( "
            r"\Phi^{-1}(v_{r i}) \right), \qquad "
            r"\hat{p}_f = \frac{1}{R} \sum_{r=1}^{R} \hat{p}_r, \qquad "
            r"\hat{\sigma}^2 = \frac{1}{R (R - 1)} \sum_{r=1}^{R} "
            r"\left( \hat{p}_r - \hat{p}_f \right)^2",
        ),
    ),
    references=(
        "Sobol' I.M. On the distribution of points in a cube and the approximate evaluation of "
        "integrals. USSR Computational Mathematics and Mathematical Physics 7 (1967) 86-112.",
        "Owen A.B. Randomly permuted (t,m,s)-nets and (t,s)-sequences. Monte Carlo and "
        "Quasi-Monte Carlo Methods in Scientific Computing, Springer, 1995, 299-317.",
        "L'Ecuyer P., Lemieux C. Recent advances in randomized quasi-Monte Carlo methods. Modeling "
        "Uncertainty, Springer, 2002, 419-474.",
        "L'Ecuyer P., Nakayama M.K., Owen A.B., Tuffin B. Confidence intervals for randomized "
        "quasi-Monte Carlo estimators. Winter Simulation Conference, 2023, 445-456.",
    ),
)
