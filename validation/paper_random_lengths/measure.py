"""Claims of the paper, judged by the studies; see `validation.paper`."""

from uqfold.evidence import Measurement
from uqfold.evidence.work import Work
from validation.paper.claims import measure_claims

CLAIMS = ("closing gap", "range of T")


def measure(work: Work) -> Measurement:
    """Judge the claims; the tiers do not differ."""
    return measure_claims(work, CLAIMS)
