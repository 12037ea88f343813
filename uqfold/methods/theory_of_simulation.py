"""What simulation and FORM state of themselves."""

from uqfold.methods.theory import Equation, Theory

_CLOPPER_PEARSON = (
    "Clopper C.J., Pearson E.S. The use of confidence or fiducial limits illustrated in the case "
    "of the binomial. Biometrika 26 (1934) 404-413."
)
_OPENTURNS = (
    "Baudin M., Dutfoy A., Iooss B., Popelin A.-L. OpenTURNS: an industrial software for "
    "uncertainty quantification in simulation. Handbook of Uncertainty Quantification, "
    "Springer, 2017, 2001-2038."
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
        "shared inputs gets several missions of responses, which are independent given the draw. "
        "In series of equal units they are also alike, so all ways to choose the responses of one "
        "system among them are averaged. Where units differ, in any other structure and under a "
        "synchronization threshold, the responses are put together to missions in six random "
        "ways, each unit that differs keeping its own, and the missions that fail are counted. "
        "Within a block the shared draws are stratified; the stated error is that of sampling, "
        "from the spread of the block means."
    ),
    equations=(
        Equation(
            "In series of n equal units, with F failed responses among the K = n B of a shared "
            "draw, the probability that all work over m missions is estimated without bias by",
            r"\hat{q} = \binom{K - F}{n m} \Big/ \binom{K}{n m}",
        ),
        Equation(
            "in all other systems, with F failed missions among the B of an arrangement, averaged "
            "over six random arrangements of the responses into missions, by",
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

MULTIFIDELITY = Theory(
    summary=(
        "Monte Carlo with a cheap partner of the model. The partner judges many systems; the model "
        "runs on some of them, chosen with unequal probabilities that are nowhere zero, and "
        "corrects the verdicts of the partner without bias. A pilot shows how the margins of the "
        "two differ near the limits; from that follow the probability that a verdict is wrong, how "
        "often the model is asked, and how many systems the partner gets. The interval goes on to "
        "what the partner may hide where no system of the sample has shown it wrong."
    ),
    equations=(
        Equation(
            "Of N systems, L = 1 marks those that fail by the partner and H = 1 those that fail by "
            "the model, which is run on a sample S, each chosen with its own probability",
            r"\hat{p}_f = \frac{1}{N} \sum_{i=1}^{N} L_i + \frac{1}{N} \sum_{i \in S} "
            r"\frac{H_i - L_i}{\pi_i}",
        ),
        Equation(
            "with the standard error",
            r"\hat{\sigma}^2 = \frac{\hat{p}_f (1 - \hat{p}_f)}{N} + \frac{1}{N^2} "
            r"\sum_{i \in S} \frac{1 - \pi_i}{\pi_i^2} (H_i - L_i)^2",
        ),
        Equation(
            "The probabilities follow the chance q that the partner's verdict is wrong at its "
            "margin, beside a part a that is spread evenly",
            r"\pi_i \propto (1 - a) \frac{\sqrt{q_i}}{\operatorname{mean} \sqrt{q}} + a",
        ),
    ),
    references=(
        "Neyman J. Contribution to the theory of sampling human populations. Journal of the "
        "American Statistical Association 33 (1938) 101-116.",
        "Duffield N., Lund C., Thorup M. Priority sampling for estimation of arbitrary subset "
        "sums. Journal of the ACM 54 (2007) 32.",
        "Ng L.W.T., Willcox K.E. Multifidelity approaches for optimization under uncertainty. "
        "International Journal for Numerical Methods in Engineering 100 (2014) 746-772.",
        "Peherstorfer B., Cui T., Marzouk Y., Willcox K. Multifidelity importance sampling. "
        "Computer Methods in Applied Mechanics and Engineering 300 (2016) 490-509.",
        "Fay M.P., Feuer E.J. Confidence intervals for directly standardized rates: a method "
        "based on the gamma distribution. Statistics in Medicine 16 (1997) 791-801.",
        "Zou G.Y., Donner A. Construction of confidence limits about effect measures: a general "
        "approach. Statistics in Medicine 27 (2008) 1693-1702.",
    ),
)

SUBSET_SIMULATION = Theory(
    summary=(
        "Subset simulation on the whole system, in standard-normal space. A rare failure is "
        "reached by levels of the response, a tenth of what exceeds one exceeding the next; "
        "Markov chains by conditional sampling populate each level. A pilot settles levels and "
        "steps. The climbs after it are independent of it and of each other, and each is without "
        "bias, so that their spread is the error of their mean, whatever the chains are correlated "
        "like; the interval is that of Student's t for the logarithm of the mean."
    ),
    equations=(
        Equation(
            "Failure lies in the highest of L nested events, and the shares of the samples that "
            "go from one to the next are multiplied",
            r"p_f = P(F_1) \prod_{i=1}^{L - 1} P(F_{i+1} \mid F_i) \; P(F \mid F_L)",
        ),
        Equation(
            "A chain above level i proposes, and stays where it is if the proposal is not above it",
            r"u' = \sqrt{1 - \sigma_i^2}\, u + \sigma_i\, \xi, \qquad \xi \sim N(0, I)",
        ),
        Equation(
            "R climbs give, with the larger one of two relative errors, from the variance of the "
            "estimates and from that of their logarithms s² under a lognormal law",
            r"\hat{p}_f = \frac{1}{R} \sum_{r=1}^{R} \hat{p}_r, \qquad "
            r"\hat{\delta}^2 = \max\left\{ \frac{\operatorname{var} \hat{p}_r}{R\, \hat{p}_f^2}, "
            r"\; \frac{s^2}{R} + \frac{s^4}{2 (R - 1)} \right\}",
        ),
    ),
    references=(
        "Au S.-K., Beck J.L. Estimation of small failure probabilities in high dimensions by "
        "subset simulation. Probabilistic Engineering Mechanics 16 (2001) 263-277.",
        "Papaioannou I., Betz W., Zwirglmaier K., Straub D. MCMC algorithms for subset simulation. "
        "Probabilistic Engineering Mechanics 41 (2015) 89-103.",
        "Del Moral P. Feynman-Kac Formulae: Genealogical and Interacting Particle Systems with "
        "Applications. Springer, 2004.",
        "Zhou X.-H., Gao S. Confidence intervals for the log-normal mean. Statistics in Medicine "
        "16 (1997) 783-790.",
    ),
)

IMPORTANCE_SAMPLING = Theory(
    summary=(
        "Importance sampling on the whole system, in standard-normal space. Short climbs of subset "
        "simulation find failures. A mixture of von Mises-Fisher directions and Nakagami "
        "distances is fitted to them, and round by round to weighted samples of the mixture itself "
        "(cross-entropy method); how many components it has, one half of the samples says of a fit "
        "to the other. A fifth of the density goes elsewhere, in all directions and as far out as "
        "a region may have some of pf. The answer comes from fresh samples alone, so that it is "
        "without bias; a region that neither climbs nor samples have met is missing from it, and "
        "what part of pf that may be belongs to the error."
    ),
    equations=(
        Equation(
            "The density is a mixture in the direction a and the distance r of u = r a",
            r"q(u) \propto \sum_{k=1}^{K} \pi_k \, "
            r"\exp\left( \kappa_k \mu_k^{\mathsf{T}} a \right) r^{2 m_k - d} "
            r"\exp\left( -\frac{m_k}{\Omega_k} r^2 \right)",
        ),
        Equation(
            "N fresh samples give, with the weights w = φ/q of the standard normal density φ",
            r"\hat{p}_f = \frac{1}{N} \sum_{i=1}^{N} w_i \, \mathbf{1}_F(u_i), \qquad "
            r"\hat{\sigma}^2 = \frac{1}{N (N - 1)} \sum_{i=1}^{N} "
            r"\left( w_i \mathbf{1}_F(u_i) - \hat{p}_f \right)^2",
        ),
        Equation(
            "The part x of pf in a region of its own is missed by climbs with M_k seeds at level k "
            "with a probability of about exp(-x/t), where s² = 3 is the variance of the seeds that "
            "one seed leads to; so t, as the mean of an exponential law, is a part of the error",
            r"t = \frac{s^2}{2} \sum_{k=1}^{L} \frac{1}{M_k}, \qquad "
            r"\hat{\sigma}_\text{stated}^2 = \hat{\sigma}^2 + t^2 \hat{p}_f^2, \qquad "
            r"p_\text{high} = \frac{p_{97.5}}{1 - t \ln 20}",
        ),
    ),
    references=(
        "Athreya K.B., Ney P.E. Branching processes. Springer, 1972, theorem I.9.1.",
        "Papaioannou I., Geyer S., Straub D. Improved cross entropy-based importance sampling with "
        "a flexible mixture model. Reliability Engineering and System Safety 191 (2019) 106564.",
        "Chan J.C.C., Kroese D.P. Improved cross-entropy method for estimation. Statistics and "
        "Computing 22 (2012) 1031-1040.",
        "Banerjee A., Dhillon I.S., Ghosh J., Sra S. Clustering on the unit hypersphere using von "
        "Mises-Fisher distributions. Journal of Machine Learning Research 6 (2005) 1345-1382.",
        "Fay M.P., Feuer E.J. Confidence intervals for directly standardized rates: a method based "
        "on the gamma distribution. Statistics in Medicine 16 (1997) 791-801.",
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
        "trusted: further runs measure the curvature of the limit state there, and further "
        "searches look for other design points. What the plane leaves out is the stated error "
        "while it is small; where it is not, the answer is doubtful, and both numbers are told. "
        "Units that differ have a plane each; out of series the planes are compared with the "
        "responses where the system fails."
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
        Equation(
            "With the main curvatures κ of the limit state at the design point second order gives "
            "for one unit",
            r"p_f \approx \Phi(-\beta) \prod_i \left( 1 + "
            r"\frac{\varphi(\beta)}{\Phi(-\beta)} \kappa_i \right)^{-1/2}",
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
        "Hohenbichler M., Rackwitz R. Improvement of second-order reliability estimates by "
        "importance sampling. Journal of Engineering Mechanics 114 (1988) 2195-2199.",
        _OPENTURNS,
    ),
)

SORM = Theory(
    summary=(
        "Second-order reliability method for one unit. Design points are those of FORM. At each of "
        "them a paraboloid with the main curvatures of the limit state takes the place of the "
        "tangent plane; the probability behind it is an integral, which well-known formulas "
        "approximate. Several design points are joined by the multinormal probability behind any "
        "of their planes. The stated error adds up what formulas, longer distances, other rays, "
        "and points on the tangent plane, before it and all around show of what is left out."
    ),
    equations=(
        Equation(
            "With the main curvatures κ at the distance β the probability behind the paraboloid "
            "is, for any c > 0 left of all -1/κ,",
            r"p = \frac{1}{2 \pi \mathrm{i}} \int_{c - \mathrm{i} \infty}^{c + \mathrm{i} \infty} "
            r"\mathrm{e}^{s^2 / 2 - s \beta} \prod_i (1 + s \kappa_i)^{-1/2} "
            r"\frac{\mathrm{d} s}{s}",
        ),
        Equation(
            "Breitung's formula, for ψ = β, and that of Hohenbichler and Rackwitz, for "
            "ψ = φ(β) / Φ(-β), approximate it by",
            r"p \approx \Phi(-\beta) \prod_i (1 + \psi \kappa_i)^{-1/2}",
        ),
        Equation(
            "P design points with planes as far out as their paraboloids are unlikely, and "
            "directions α, give",
            r"p_f \approx \Pr\left[ \bigcup_{j=1}^{P} \left\{ \alpha_j^{\mathsf{T}} U > "
            r"-\Phi^{-1}(p_j) \right\} \right]",
        ),
    ),
    references=(
        "Tvedt L. Distribution of quadratic forms in normal space: application to structural "
        "reliability. Journal of Engineering Mechanics 116 (1990) 1183-1197.",
        "Breitung K. Asymptotic approximations for multinormal integrals. Journal of Engineering "
        "Mechanics 110 (1984) 357-366.",
        "Hohenbichler M., Rackwitz R. Improvement of second-order reliability estimates by "
        "importance sampling. Journal of Engineering Mechanics 114 (1988) 2195-2199.",
        "Ditlevsen O. Narrow reliability bounds for structural systems. Journal of Structural "
        "Mechanics 7 (1979) 453-472.",
        _OPENTURNS,
    ),
)
