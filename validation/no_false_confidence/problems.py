"""Problems on which a method may be wrong without knowing, each with its exact answer."""

from __future__ import annotations

from validation.no_false_confidence.broken import BAD
from validation.no_false_confidence.hard import Hard
from validation.no_false_confidence.rough import ROUGH, SEVERAL, THIN
from validation.no_false_confidence.shaped import REAL, SHAPED
from validation.no_false_confidence.smooth import SMOOTH

PROBLEMS: list[Hard] = [*SMOOTH, *ROUGH, *SEVERAL, *THIN, *SHAPED, *REAL, *BAD]
