"""What the methods that integrate over all inputs (FFNI) state of themselves."""

from uqfold.methods.theory import Equation, Theory

_PAPER = (
    "Reliability assessment of folding wing system deployment performance considering failure "
    "correlation: the paper whose equation numbers are given."
)
_OUTER = Equation(
    "Gauss rules over the K nodes of the shared inputs turn the expectation into a sum with "
    "weights w; for n units and m missions",
    r"p_f \approx \sum_{k=1}^{K} w_k \left\{ 1 - \left[ H_k(T) \right]^{n m} \right\}",
    "Eqs. (28), (31)",
)
_MOMENTS = Equation(
    "at each shared node v, Gauss rules over the individual inputs x give the raw moments of the "
    "response y of one unit",
    r"\mu'_r(v_k) = \sum_{q=1}^{Q} w_q \, y(v_k, x_q)^r, \qquad r = 1, \dots, 4",
    "Eqs. (33), (41)",
)

SADDLEPOINT = Theory(
    summary=(
        "Full-factorial numerical integration (FFNI) with the saddlepoint approximation. The "
        "model is run at every node of a product of Gauss rules; from the first four cumulants at "
        "each shared node the formula of Lugannani and Rice gives both tails of the conditional "
        "response. Where the cumulants admit no saddlepoint, the Pearson distribution with the "
        "same moments answers. Runs beside the design, finer rules and other distributions with "
        "the same moments tell the stated error."
    ),
    equations=(
        _OUTER,
        _MOMENTS,
        Equation(
            "with the cumulants the cumulant-generating function is approximated by",
            r"\hat{K}(s) = \kappa_1 s + \frac{\kappa_2 s^2}{2} + \frac{\kappa_3 s^3}{6} "
            r"+ \frac{\kappa_4 s^4}{24}",
            "Eq. (32)",
        ),
        Equation(
            "the saddlepoint s at the threshold solves",
            r"\hat{K}'(s) = T",
            "Eq. (34)",
        ),
        Equation(
            "and the conditional distribution function is",
            r"H_k(T) = \Phi(w) + \varphi(w) \left( \frac{1}{w} - \frac{1}{v} \right), \qquad "
            r"w = \operatorname{sgn}(s) \sqrt{2 \left[ s T - \hat{K}(s) \right]}, \qquad "
            r"v = s \sqrt{\hat{K}''(s)}",
            "Eqs. (35), (36)",
        ),
    ),
    references=(
        _PAPER,
        "Lugannani R., Rice S. Saddle point approximation for the distribution of the sum of "
        "independent random variables. Advances in Applied Probability 12 (1980) 475-490.",
        "Daniels H.E. Tail probability approximations. International Statistical Review 55 (1987) "
        "37-48.",
    ),
)

PEARSON = Theory(
    summary=(
        "Full-factorial numerical integration (FFNI) with a Pearson distribution. The model is "
        "run at every node of a product of Gauss rules; the first four moments at each shared "
        "node select one member of the Pearson family as the conditional distribution of the "
        "response. Under a synchronization threshold the order statistics of the units follow by "
        "integration, without sampling unless rows are asked for. Runs beside the design, finer "
        "rules and other distributions with the same moments tell the stated error."
    ),
    equations=(
        _OUTER,
        _MOMENTS,
        Equation(
            "the density f of the standardised response z satisfies",
            r"\frac{1}{f} \frac{\mathrm{d} f}{\mathrm{d} z} = "
            r"- \frac{a z + b}{c + b z + d z^2}",
            "Eq. (42)",
        ),
        Equation(
            "with skewness s and kurtosis k in",
            r"a = 10 k - 12 s^2 - 18, \quad b = s (k + 3), \quad c = 4 k - 3 s^2, \quad "
            r"d = 2 k - 3 s^2 - 6",
        ),
        Equation(
            "under a synchronization threshold a mission works with the conditional probability",
            r"q_k = n \int_{-\infty}^{T} h_k(t) "
            r"\left[ H_k(\min(t + \tau, T)) - H_k(t) \right]^{n - 1} \mathrm{d} t",
            "Eqs. (37), (38)",
        ),
    ),
    references=(
        _PAPER,
        "Zhao Y.G., Ono T. On the problems of the fourth moment method. Structural Safety 26 "
        "(2004) 343-347.",
        "David H.A., Nagaraja H.N. Order Statistics. 3rd ed., Wiley, 2003.",
    ),
)

COMPOSED = Theory(
    summary=(
        "Full-factorial numerical integration (FFNI) put together from its parts. The model is "
        "run at Gauss nodes of the shared inputs, times a full factorial, a sparse grid or a "
        "dimension reduction over the individual inputs. A polynomial goes through the responses; "
        "its moments at each shared node, up to six of them, select the conditional distribution. "
        "The rule over the shared inputs is refined on the polynomial, which takes no runs but two "
        "nodes more along each shared input. Runs beside the design, finer rules and other "
        "distributions with the same moments tell the stated error."
    ),
    equations=(
        _OUTER,
        Equation(
            "the polynomial is a sum of products of Lagrange's polynomials with shares c, one for "
            "each product of nodes",
            r"q(v, x) = \sum_g c_g \sum_j y_j \, \ell_j^{(g)}(v, x)",
        ),
        Equation(
            "with standardised moments the cubic normal distribution has, for standard normal u,",
            r"\frac{y - \mu}{\sigma} = -c + b u + c u^2 + d u^3",
        ),
        Equation(
            "a response of degree two in standard normal inputs, with eigenvalues l and slopes b, "
            "has the cumulant-generating function",
            r"K(s) = \sum_i \left[ - \tfrac{1}{2} \log(1 - 2 l_i s) "
            r"+ \frac{b_i^2 s^2}{2 (1 - 2 l_i s)} \right]",
        ),
    ),
    references=(
        _PAPER,
        "Rahman S., Xu H. A univariate dimension-reduction method for multi-dimensional "
        "integration in stochastic mechanics. Probabilistic Engineering Mechanics 19 (2004) "
        "393-408.",
        "Fleishman A.I. A method for simulating non-normal distributions. Psychometrika 43 (1978) "
        "521-532.",
        "Imhof J.P. Computing the distribution of quadratic forms in normal variables. Biometrika "
        "48 (1961) 419-426.",
    ),
)
