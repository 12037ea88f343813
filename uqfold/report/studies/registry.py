"""The kinds of figure and table that a study may ask for: one file each, one line here.

The `call` of a kind takes the settings of the figure or table (values of its keys) and all tables
of the study by name (`Mapping[str, pandas.DataFrame]`, with ``problems`` and ``inputs`` among
them). A figure gives a `matplotlib.figure.Figure`, bound to no
window, or the text of an SVG picture where its kind says so; a table a pandas frame of
texts whose columns are the headings. Neither runs a model.
"""

from __future__ import annotations

from uqfold.comparison.studies.keys import Kind
from uqfold.comparison.studies.registry import loaded_kinds

_FIGURES: dict[str, str] = {
    "animation": "uqfold.report.studies.mechanism:ANIMATION",
    "budgets": "uqfold.report.studies.benchmark:BUDGETS",
    "conditions": "uqfold.report.studies.conditions:CONDITIONS",
    "derivative-curves": "uqfold.report.studies.sensitivity:DERIVATIVE_CURVES",
    "derivatives": "uqfold.report.studies.sensitivity:DERIVATIVES_FIGURE",
    "designs": "uqfold.report.studies.designs:DESIGNS_FIGURE",
    "independence": "uqfold.report.studies.independence:INDEPENDENCE",
    "mechanism": "uqfold.report.studies.mechanism:MECHANISM",
    "motion": "uqfold.report.studies.mechanism:MOTION",
    "reliability": "uqfold.report.studies.reliability:RELIABILITY",
    "sobol": "uqfold.report.studies.sensitivity:SOBOL_FIGURE",
}
_TABLES: dict[str, str] = {
    "agreement": "uqfold.report.studies.agreement:AGREEMENT",
    "changed-inputs": "uqfold.report.studies.changed_inputs:CHANGED_INPUTS",
    "designs": "uqfold.report.studies.designs:DESIGNS",
    "errors": "uqfold.report.studies.error_table:ERRORS",
    "evaluations": "uqfold.report.studies.evaluations:EVALUATIONS",
    "inputs": "uqfold.report.studies.inputs:INPUTS",
    "ranking": "uqfold.report.studies.ranking:RANKING",
    "seconds": "uqfold.report.studies.ranking:SECONDS",
    "trust": "uqfold.report.studies.ranking:TRUST",
}


def figure_kinds() -> dict[str, Kind]:
    """Map the name of every kind of figure to the kind."""
    return loaded_kinds(_FIGURES)


def table_kinds() -> dict[str, Kind]:
    """Map the name of every kind of table to the kind."""
    return loaded_kinds(_TABLES)
