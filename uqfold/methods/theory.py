r"""What each method states of itself: its idea, its equations, and whom to cite.

A method names its `Theory` in the class attribute ``theory``; a comparison keeps it in its records,
and reports make their methods section from there. Equations are LaTeX; numbers in parentheses are
those of the folding-wing paper.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Equation:
    """One displayed equation.

    Attributes
    ----------
    lead
        The sentence that leads to it, without a full stop.
    latex
        The equation.
    source
        Where it stands, for instance ``Eq. (35)``; may be empty.
    """

    lead: str
    latex: str
    source: str = ""


@dataclass(frozen=True)
class Theory:
    """What a method is, for the methods section of a report.

    Attributes
    ----------
    summary
        A few sentences: what is done, what is assumed, what the stated error covers.
    equations
        In the order in which they are used.
    references
        Publications to cite.
    """

    summary: str = ""
    equations: tuple[Equation, ...] = ()
    references: tuple[str, ...] = ()


_PAPER = (
    "Reliability assessment of folding wing system deployment performance considering failure "
    "correlation: the paper whose equation numbers are given."
)
_CLOPPER_PEARSON = (
    "Clopper C.J., Pearson E.S. The use of confidence or fiducial limits illustrated in the case "
    "of the binomial. Biometrika 26 (1934) 404-413."
)
_ECHARD = (
    "Echard B., Gayton N., Lemaire M. AK-MCS: an active learning reliability method combining "
    "Kriging and Monte Carlo simulation. Structural Safety 33 (2011) 145-154."
)
_OPENTURNS = (
    "Baudin M., Dutfoy A., Iooss B., Popelin A.-L. OpenTURNS: an industrial software for "
    "uncertainty quantification in simulation. Handbook of Uncertainty Quantification, "
    "Springer, 2017, 2001-2038."
)
_RASMUSSEN = (
    "Rasmussen C.E., Williams C.K.I. Gaussian Processes for Machine Learning. MIT Press, 2006."
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
_CONDITIONAL = Equation(
    "The conditional distribution of the response of one unit given the shared inputs v follows "
    "from the surface by integration over the individual variables",
    r"H(t \mid v) = \int \mathbf{1}\left[ \hat{g}(v, u) \le t \right] \varphi(u) \, \mathrm{d}u",
)

SADDLEPOINT = Theory(
    summary=(
        "Full-factorial numerical integration (FFNI) with the saddlepoint approximation. The "
        "model is run at every node of a product of Gauss rules; from the first four cumulants at "
        "each shared node the formula of Lugannani and Rice gives both tails of the conditional "
        "response. Where the cumulants admit no saddlepoint, the Pearson distribution with the "
        "same moments answers. The method states no error of its own."
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
        "integration, without sampling unless rows are asked for. The method states no error "
        "besides that of sampling."
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

MONTE_CARLO = Theory(
    summary=(
        "Crude Monte Carlo on the system itself. Each system draws its shared inputs once, and "
        "its individual inputs for every unit and every mission; all criteria are read off the "
        "same systems. Nothing is approximated but by sampling, and the stated error is that of "
        "sampling."
    ),
    equations=(
        Equation(
            "Of N systems, k fail",
            r"\hat{p}_f = \frac{k}{N}, \qquad "
            r"\hat{\sigma} = \sqrt{\frac{\hat{p}_f (1 - \hat{p}_f)}{N}}",
        ),
        Equation(
            "the interval at level 1 - α has as its ends the quantiles of two beta distributions",
            r"\left[ B^{-1}_{k,\, N - k + 1}\left(\tfrac{\alpha}{2}\right), \; "
            r"B^{-1}_{k + 1,\, N - k}\left(1 - \tfrac{\alpha}{2}\right) \right]",
        ),
    ),
    references=(_CLOPPER_PEARSON,),
)

CONDITIONAL_MONTE_CARLO = Theory(
    summary=(
        "Monte Carlo on the real model that uses the structure of the system. Each draw of the "
        "shared inputs gets several missions of responses; given the draw these are independent "
        "and alike, so all ways to choose the responses of one system among them are averaged. "
        "Within a block the shared draws are stratified; the stated error is that of sampling, "
        "from the spread of the block means."
    ),
    equations=(
        Equation(
            "With F failed responses among the K = n B of a shared draw, the probability that n "
            "units over m missions all work is estimated without bias by",
            r"\hat{q} = \binom{K - F}{n m} \Big/ \binom{K}{n m}",
        ),
        Equation(
            "under a synchronization threshold, with F failed missions among B, averaged over "
            "several arrangements of the responses into missions, by",
            r"\hat{q} = \binom{B - F}{m} \Big/ \binom{B}{m}",
        ),
        Equation(
            "with the mean over shared draws and blocks",
            r"\hat{p}_f = \operatorname{mean}(1 - \hat{q}), \qquad \hat{\sigma} = "
            r"\sqrt{\frac{1}{N (N - 1)} \sum_{j=1}^{N} \left( \hat{p}_j - \hat{p}_f \right)^2}",
        ),
    ),
    references=(
        "Hoeffding W. A class of statistics with asymptotically normal distribution. Annals of "
        "Mathematical Statistics 19 (1948) 293-325.",
        "McKay M.D., Beckman R.J., Conover W.J. A comparison of three methods for selecting "
        "values of input variables in the analysis of output from a computer code. "
        "Technometrics 21 (1979) 239-245.",
    ),
)

OPENTURNS_MONTE_CARLO = Theory(
    summary=(
        "Monte Carlo simulation by OpenTURNS. The whole system is one event in standard-normal "
        "space; each criterion is simulated by itself until the coefficient of variation of the "
        "estimate falls to its target or the samples run out. The stopping rule looks at the "
        "failures, so standard error and interval are approximate."
    ),
    equations=(
        Equation(
            "Of N systems, k fail; the simulation stops when",
            r"\hat{p}_f = \frac{k}{N}, \qquad "
            r"\sqrt{\frac{1 - \hat{p}_f}{N \hat{p}_f}} \le \mathrm{CoV}_{\text{target}}",
        ),
    ),
    references=(_OPENTURNS, _CLOPPER_PEARSON),
)

FORM = Theory(
    summary=(
        "First-order reliability method on one unit, by OpenTURNS. The limit state of one unit is "
        "replaced by a plane at its design point in standard-normal space; units and missions are "
        "joined through the shared part of the design direction. The point found is checked, not "
        "trusted. The method states no error: the curvature of the limit state is neglected, and "
        "so are further design points."
    ),
    equations=(
        Equation(
            "The design point of the limit state y(u) = T is",
            r"u^* = \underset{u}{\operatorname{argmin}} "
            r"\left\{ \lVert u \rVert : y(u) = T \right\}, \qquad "
            r"\beta = \pm \lVert u^* \rVert, \qquad "
            r"\alpha = \frac{\nabla y(u^*)}{\lVert \nabla y(u^*) \rVert}",
        ),
        Equation(
            "with the shared part of α the linearised responses of all units and missions "
            "have the common correlation",
            r"\rho = \lVert \alpha_{\text{shared}} \rVert^2",
        ),
        Equation(
            "and n units over m missions fail with",
            r"p_f \approx \int_{-\infty}^{\infty} \varphi(z) \left\{ 1 - \left[ \Phi\left( "
            r"\frac{\beta - \sqrt{\rho}\, z}{\sqrt{1 - \rho}} \right) \right]^{n m} \right\} "
            r"\mathrm{d} z",
        ),
    ),
    references=(
        "Hasofer A.M., Lind N.C. Exact and invariant second-moment code format. Journal of the "
        "Engineering Mechanics Division ASCE 100 (1974) 111-121.",
        "Abdo T., Rackwitz R. A new beta-point algorithm for large time-invariant and "
        "time-variant reliability problems. 3rd IFIP WG 7.5 Conference, 1990.",
        "Dunnett C.W., Sobel M. Approximations to the probability integral and certain percentage "
        "points of a multivariate analogue of Student's t-distribution. Biometrika 42 (1955) "
        "258-260.",
        _OPENTURNS,
    ),
)

KRIGING = Theory(
    summary=(
        "A Gaussian process with a polynomial trend and learned noise is fitted to model runs at "
        "a space-filling design in standard-normal space, spread wider than the inputs. The "
        "conditional distributions follow by integration over the surface, without sampling. "
        "Surfaces drawn from the posterior give the stated error; it covers the fit, not a "
        "failure region that no run has come near."
    ),
    equations=(
        Equation(
            "The response is modelled as trend, stationary process and noise",
            r"y(u) = f(u)^{\mathsf{T}} b + Z(u) + \varepsilon, \qquad "
            r"\operatorname{Cov}\left[ Z(u), Z(u') \right] = \sigma^2 R(u - u')",
        ),
        Equation(
            "with r the correlations of u with the runs y at the design, F the trend there and C "
            "their correlations with noise, the surface is",
            r"\hat{g}(u) = f(u)^{\mathsf{T}} \hat{b} + r(u)^{\mathsf{T}} C^{-1} "
            r"\left( y - F \hat{b} \right)",
        ),
        _CONDITIONAL,
    ),
    references=(
        _RASMUSSEN,
        "Sacks J., Welch W.J., Mitchell T.J., Wynn H.P. Design and analysis of computer "
        "experiments. Statistical Science 4 (1989) 409-423.",
    ),
)

POLYNOMIAL_CHAOS = Theory(
    summary=(
        "The response is expanded in orthonormal Hermite polynomials of the standard-normal "
        "variables and fitted by regression; the corrected leave-one-out error chooses the "
        "degree, least-angle regression the terms. The conditional distributions follow by "
        "integration over the expansion, without sampling. The residuals are carried into the "
        "stated error."
    ),
    equations=(
        Equation(
            "The expansion over a set A of multi-indices α is",
            r"\hat{g}(u) = \sum_{\alpha \in A} c_\alpha \prod_{i=1}^{d} \psi_{\alpha_i}(u_i)",
        ),
        Equation(
            "with h the leverage of each run, its leave-one-out error is",
            r"\epsilon_{\text{LOO}} = \frac{1}{N} \sum_{i=1}^{N} "
            r"\left( \frac{y_i - \hat{g}(u_i)}{1 - h_i} \right)^2",
        ),
        _CONDITIONAL,
    ),
    references=(
        "Blatman G., Sudret B. Adaptive sparse polynomial chaos expansion based on least angle "
        "regression. Journal of Computational Physics 230 (2011) 2345-2367.",
        "Sudret B. Global sensitivity analysis using polynomial chaos expansions. Reliability "
        "Engineering and System Safety 93 (2008) 964-979.",
    ),
)

ACTIVE_KRIGING = Theory(
    summary=(
        "A Gaussian process that chooses its own runs. Candidates gather where the surface "
        "decides the answers; a learning function picks a batch of them; learning ends when the "
        "reliability indices stay and runs kept out of the training set agree with the surface. "
        "The answers follow by integration over the surface, and its posterior gives the stated "
        "error."
    ),
    equations=(
        *KRIGING.equations[:2],
        Equation(
            "by default the next runs reduce the posterior variance of the failure probabilities "
            "most, to first order in the surface",
            r"x_{\text{new}} = \underset{x}{\operatorname{argmax}} "
            r"\left\{ \operatorname{Var}\left[ p_f \right] - "
            r"\operatorname{Var}\left[ p_f \mid y(x) \right] \right\}",
        ),
        _CONDITIONAL,
    ),
    references=(
        _ECHARD,
        "Bect J., Ginsbourger D., Li L., Picheny V., Vazquez E. Sequential design of computer "
        "experiments for the estimation of a probability of failure. Statistics and Computing 22 "
        "(2012) 773-793.",
        _RASMUSSEN,
    ),
)
