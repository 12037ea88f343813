from uqfold.analysis.conditional_indices import conditional_sobol as conditional_sobol
from uqfold.analysis.derivatives_by_simulation import score_derivatives as score_derivatives
from uqfold.analysis.derivatives_by_surface import surface_derivatives as surface_derivatives
from uqfold.analysis.design import Design as Design, Scan as Scan
from uqfold.analysis.design_table import designs_to_frame as designs_to_frame
from uqfold.analysis.designed_input import design_input as design_input
from uqfold.analysis.designed_threshold import (
    design_threshold as design_threshold,
    design_thresholds as design_thresholds,
)
from uqfold.analysis.fitted_surface import NoSurfaceError as NoSurfaceError
from uqfold.analysis.importance_of_units import importance_of_units as importance_of_units
from uqfold.analysis.joint_failures import joint_failures as joint_failures
from uqfold.analysis.independent_units import independence as independence
from uqfold.analysis.paired import (
    PairedDifference as PairedDifference,
    PairedDifferences as PairedDifferences,
    paired_differences as paired_differences,
)
from uqfold.analysis.pf_derivatives import (
    InputParameter as InputParameter,
    PfDerivative as PfDerivative,
    PfDerivatives as PfDerivatives,
)
from uqfold.analysis.sobol import chaos_sobol as chaos_sobol, pick_freeze as pick_freeze
from uqfold.analysis.sobol_rows import SobolIndex as SobolIndex, SobolIndices as SobolIndices
from uqfold.analysis.verification import (
    Verification as Verification,
    verify as verify,
    verify_all as verify_all,
)
