"""The paper's method against the reference of this example; see `validation.examples`."""

from uqfold.evidence import Measurement
from uqfold.evidence.work import Work
from uqfold.problems import series
from validation.examples.ffni_errors import BODY, measure_errors


def measure(work: Work) -> Measurement:
    """Measure all criteria; the tiers do not differ."""
    return measure_errors(work, series(), BODY)
