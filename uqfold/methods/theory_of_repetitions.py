"""What methods state of themselves whose error is the spread of independent repetitions."""

from uqfold.methods.theory import Equation, Theory

NAIS = Theory(
    summary=(
        "Nonparametric adaptive importance sampling by OpenTURNS, on the whole system in "
        "standard-normal space. Samples of a density that come nearest to failure, weighted, are "
        "the kernels of the next density, until a quarter of the samples fails. The algorithm is "
        "run several times; the spread of the runs is the stated error. Climbs of subset "
        "simulation look for regions of failure that its densities have lost."
    ),
    equations=(
        Equation(
            "The density of level k + 1 is made of the N samples of level k, with kernels K and "
            "weights w = φ/q of those above the level's quantile γ",
            r"q_{k+1}(u) \propto \sum_{i=1}^{N} w_k(u_i)\, \mathbf{1}_{y(u_i) > \gamma_k}\, "
            r"K_{h_k}(u - u_i)",
        ),
        Equation(
            "and R runs, each from N samples of its last density, give",
            r"\hat{p}_r = \frac{1}{N} \sum_{i=1}^{N} w_r(u_i)\, \mathbf{1}_F(u_i), \qquad "
            r"\hat{p}_f = \frac{1}{R} \sum_{r=1}^{R} \hat{p}_r",
        ),
    ),
    references=(
        "Morio J. Extreme quantile estimation with nonparametric adaptive importance sampling. "
        "Simulation Modelling Practice and Theory 27 (2012) 76-89.",
        "Zhang P. Nonparametric importance sampling. Journal of the American Statistical "
        "Association 91 (1996) 1245-1253.",
    ),
)

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
