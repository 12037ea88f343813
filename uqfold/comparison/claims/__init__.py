"""The paper's claims, in our words, judged by the results of the studies.

>>> from uqfold.comparison.claims import CLAIMS
>>> CLAIMS["missions"].statement
'The more missions, the lower the reliability, with and without synchronization.'
"""

from uqfold.comparison.claims import (
    accuracy,
    deviations,
    independence,
    means,
    missions,
    random_lengths,
    synchronization,
)
from uqfold.comparison.claims.claim import IDENTITY, JudgedClaim, PaperClaim, StudyResults, judged

__all__ = ["CLAIMS", "IDENTITY", "JudgedClaim", "PaperClaim", "StudyResults", "judged"]

CLAIMS: dict[str, PaperClaim] = {
    claim.key: claim
    for claim in (
        accuracy.CURVES_COINCIDE,
        accuracy.ERRORS_SMALL,
        accuracy.FEW_RUNS,
        missions.MORE_MISSIONS,
        missions.RANDOM_MISSIONS,
        synchronization.LARGER_TAU,
        synchronization.GAIN_SHRINKS,
        synchronization.WHICH_GOVERNS,
        independence.CONSERVATIVE,
        independence.DISPERSION,
        means.MEANS,
        means.MEANS_CLIMB,
        means.MEANS_PLATEAU,
        means.DELTA_PLATEAU,
        means.CLEARANCE_PLATEAU,
        deviations.DEVIATIONS,
        deviations.DEVIATION_PATTERN,
        deviations.CLEARANCE_COINCIDES,
        deviations.CLEARANCE_AT_THE_END,
        deviations.DEVIATIONS_TAU,
        deviations.DEVIATIONS_VISIBLE,
        deviations.CLEARANCE_TAU,
        random_lengths.CLOSING,
        random_lengths.WINDOW,
        random_lengths.ONSET,
    )
}
"""Every claim by its key, in the order of the paper."""
