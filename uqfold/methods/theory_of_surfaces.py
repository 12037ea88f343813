"""What methods with a response surface state of themselves."""

from uqfold.methods.theory import Equation, Theory

_ECHARD = (
    "Echard B., Gayton N., Lemaire M. AK-MCS: an active learning reliability method combining "
    "Kriging and Monte Carlo simulation. Structural Safety 33 (2011) 145-154."
)
_RASMUSSEN = (
    "Rasmussen C.E., Williams C.K.I. Gaussian Processes for Machine Learning. MIT Press, 2006."
)
_CONDITIONAL = Equation(
    "The conditional distribution of the response of one unit given the shared inputs v follows "
    "from the surface by integration over the individual variables",
    r"H(t \mid v) = \int \mathbf{1}\left[ \hat{g}(v, u) \le t \right] \varphi(u) \, \mathrm{d}u",
)

KRIGING = Theory(
    summary=(
        "A Gaussian process with a polynomial trend and learned noise is fitted to evaluations at "
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
        "The response is expanded in orthonormal polynomials, those of Hermite of the "
        "standard-normal variables or those of the inputs' own distributions, and fitted by "
        "regression; the corrected leave-one-out error chooses among the two and the degree, "
        "least-angle regression the terms. The conditional distributions follow by "
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
        "Xiu D., Karniadakis G. E. The Wiener-Askey polynomial chaos for stochastic differential "
        "equations. SIAM Journal on Scientific Computing 24 (2002) 619-644.",
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

AUTOMATIC = Theory(
    summary=(
        "A Kriging surface answers first, and polynomial chaos what that doubts. Their answers are "
        "checked by runs of the model that no surface has learned, most of them where the surface "
        "says that it fails; what they doubt is sampled there with the surface as a control "
        "variate, without bias however wrong it is, then along lines and rays where there are many "
        "inputs, then by simulation of rare events with all runs that are left. Two answers that "
        "contradict each other are doubtful, whatever each of them says. The stated error is that "
        "of the method that answers, which the message names."
    ),
    equations=(
        Equation(
            "With N samples from a density h fitted to the failures S of the surface, one in ten "
            "of them elsewhere, the weights w and the failures F of the model",
            r"\hat{p}_f = \frac{1}{N} \sum_{i=1}^{N} w_i \mathbf{1}_F(u_i) - c \left[ "
            r"\frac{1}{N} \sum_{i=1}^{N} w_i \mathbf{1}_S(u_i) - P_S \right], \qquad "
            r"w = \frac{\varphi(u)}{h(u)}",
        ),
        Equation(
            "where the probability of failure by the surface, P_S, takes no runs of the model, and",
            r"c = \frac{\operatorname{Cov}\left[ w \mathbf{1}_F, w \mathbf{1}_S \right]}"
            r"{\operatorname{Var}\left[ w \mathbf{1}_S \right]}",
        ),
        Equation(
            "Two answers, the lower p_1 with the upper end b_1 of its 95 % interval and the higher "
            "p_2 with the lower end a_2, contradict each other if",
            r"p_2 - p_1 > \frac{3.5}{1.96} \sqrt{(b_1 - p_1)^2 + (p_2 - a_2)^2}",
        ),
    ),
    references=(
        _RASMUSSEN,
        "Dubourg V., Sudret B., Deheeger F. Metamodel-based importance sampling for structural "
        "reliability analysis. Probabilistic Engineering Mechanics 33 (2013) 47-57.",
        "Li J., Xiu D. Evaluation of failure probability via surrogate models. Journal of "
        "Computational Physics 229 (2010) 8966-8980.",
    ),
)
