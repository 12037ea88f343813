"""What line sampling and directional sampling state of themselves."""

from uqfold.methods.theory import Equation, Theory

LINE_SAMPLING = Theory(
    summary=(
        "Line sampling on the whole system, in standard-normal space. Gradients, and points far "
        "out in all directions, lead to the regions of failure, each with a direction of its own. "
        "Lines run in these directions through points that lie evenly; along each, the places "
        "where the system passes from working to failing are found by a few runs, and what lies "
        "beyond them has a normal probability. Two more runs at random places of each line keep "
        "the estimate without bias. Single runs between the lines tell what all of them may "
        "overlook. The stated error is that of the spread of lines, and of this."
    ),
    equations=(
        Equation(
            "A direction α_k has as its own the points that lie deepest in its plane, at the "
            "distance β_k",
            r"V_k = \left\{ u : \alpha_k^{\mathsf{T}} u - \beta_k \ge "
            r"\alpha_j^{\mathsf{T}} u - \beta_j \text{ for all } j \right\}",
        ),
        Equation(
            "R lines in each direction, through points w at right angles to it, give with the "
            "failures B that their crossings imply, a run at a place c drawn with the density q, "
            "and the normal density φ",
            r"\hat{p}_f = \frac{1}{R} \sum_{r=1}^{R} \sum_k \left\{ "
            r"\int_{B_{kr} \cap V_k} \varphi(c)\, \mathrm{d} c + \frac{\varphi(c_{kr})}{q(c_{kr})} "
            r"\left[ \mathbf{1}_F - \mathbf{1}_B \right](w_{kr} + c_{kr} \alpha_k) \right\}",
        ),
    ),
    references=(
        "Koutsourelakis P.S., Pradlwarter H.J., Schueller G.I. Reliability of structures in high "
        "dimensions, part I: algorithms and applications. Probabilistic Engineering Mechanics 19 "
        "(2004) 409-417.",
        "de Angelis M., Patelli E., Beer M. Advanced line sampling for efficient robust "
        "reliability analysis. Structural Safety 52 (2015) 170-182.",
        "Zhou X.-H., Gao S. Confidence intervals for the log-normal mean. Statistics in Medicine "
        "16 (1997) 783-790.",
    ),
)

DIRECTIONAL_SAMPLING = Theory(
    summary=(
        "Directional simulation on the whole system, in standard-normal space. Rays from the "
        "origin run in directions that are spread evenly over the sphere and turned at random; "
        "along each, the distances at which the system passes from working to failing are found "
        "by a few runs, and what lies between them has a probability by the chi distribution. Two "
        "more runs at random places of each ray keep the estimate without bias. Independent sets "
        "of rays tell the error."
    ),
    equations=(
        Equation(
            "In d variables a ray in the direction a that meets failure from r_1 to r_2, and so "
            "on, has the probability",
            r"p(a) = \sum_i \left[ F_{\chi^2_d}(r_{2i}^2) - F_{\chi^2_d}(r_{2i-1}^2) \right]",
        ),
        Equation(
            "R sets of N rays give",
            r"\hat{p}_f = \frac{1}{R} \sum_{r=1}^{R} \frac{1}{N} \sum_{i=1}^{N} p(a_{ri})",
        ),
    ),
    references=(
        "Bjerager P. Probability integration by directional simulation. Journal of Engineering "
        "Mechanics 114 (1988) 1285-1302.",
        "Ditlevsen O., Melchers R.E., Gluver H. General multi-dimensional probability integration "
        "by directional simulation. Computers and Structures 36 (1990) 355-368.",
        "Owen A.B. Scrambled net variance for integrals of smooth functions. Annals of Statistics "
        "25 (1997) 1541-1562.",
    ),
)
