from uqfold.methods.active_kriging import ActiveKriging as ActiveKriging
from uqfold.methods.automatic import Automatic as Automatic
from uqfold.methods.ask_tell_session import AskTellSession as AskTellSession
from uqfold.methods.base import ReliabilityMethod as ReliabilityMethod
from uqfold.methods.task import Solution as Solution, Task as Task
from uqfold.methods.conditional_monte_carlo import ConditionalMonteCarlo as ConditionalMonteCarlo
from uqfold.methods.directional_sampling import DirectionalSampling as DirectionalSampling
from uqfold.methods.factorial_inner import (
    DimensionReduction as DimensionReduction,
    FullFactorial as FullFactorial,
    SparseGrid as SparseGrid,
)
from uqfold.methods.factorial_outer import GaussOuter as GaussOuter, RefinedOuter as RefinedOuter
from uqfold.methods.ffni import FFNI as FFNI
from uqfold.methods.ffni_pearson import FFNIPearson as FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint as FFNISaddlepoint
from uqfold.methods.importance_sampling import ImportanceSampling as ImportanceSampling
from uqfold.methods.kriging import Kriging as Kriging
from uqfold.methods.line_sampling import LineSampling as LineSampling
from uqfold.methods.monte_carlo import MonteCarlo as MonteCarlo
from uqfold.methods.multifidelity_monte_carlo import (
    MultifidelityMonteCarlo as MultifidelityMonteCarlo,
)
from uqfold.methods.openturns_form import OpenTURNSFORM as OpenTURNSFORM
from uqfold.methods.openturns_monte_carlo import OpenTURNSMonteCarlo as OpenTURNSMonteCarlo
from uqfold.methods.openturns_nais import OpenTURNSNAIS as OpenTURNSNAIS
from uqfold.methods.polynomial_chaos import PolynomialChaos as PolynomialChaos
from uqfold.methods.quasi_monte_carlo import QuasiMonteCarlo as QuasiMonteCarlo
from uqfold.methods.registry import available as available, build as build
from uqfold.methods.result import (
    CriterionResult as CriterionResult,
    Estimate as Estimate,
    ReliabilityResult as ReliabilityResult,
)
from uqfold.methods.sorm import SORM as SORM
from uqfold.methods.steps import SequentialMethod as SequentialMethod
from uqfold.methods.subset_simulation import SubsetSimulation as SubsetSimulation
