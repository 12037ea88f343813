from uqfold.plots.comparison_figure import comparison as comparison
from uqfold.plots.curves import reliability_panels as reliability_panels
from uqfold.plots.error_figure import error_against_evaluations as error_against_evaluations
from uqfold.plots.panels import one_legend as one_legend
from uqfold.plots.points_figure import points as points
from uqfold.plots.profiles import (
    data_profile as data_profile,
    performance_profile as performance_profile,
)
from uqfold.plots.saving import save as save
from uqfold.plots.analyses import (
    design as design,
    derivatives as derivatives,
    importance as importance,
    sobol as sobol,
)
from uqfold.plots.style import figure_settings as figure_settings, method_styles as method_styles
from uqfold.plots.telling import values as values
