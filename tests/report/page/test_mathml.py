"""LaTeX to MathML: every equation of the package, and nothing but typesetting from others."""

import pytest

from uqfold.methods import ActiveKriging, Kriging, PolynomialChaos, available
from uqfold.report.page.mathml import mathml

EQUATIONS = {
    equation.latex
    for method in (*available().values(), Kriging, PolynomialChaos, ActiveKriging)
    for equation in method.theory.equations
}


@pytest.mark.parametrize("latex", sorted(EQUATIONS))
def test_every_equation_of_a_method_is_typeset(latex: str) -> None:
    found = mathml(latex)
    assert found is not None
    assert found.startswith("<math ")
    # a command that the converter does not know comes out as it went in
    assert "\\" not in found


@pytest.mark.parametrize(
    "latex",
    [
        r"\text{<script>stolen()</script>}",
        r"\text{<mtext onclick='stolen()'>x</mtext>}",
        r"\href{javascript:stolen()}{x}",
        r"\text{</math><img src=x onerror=stolen()>}",
        r"\class{x}{y}",
        r"\style{color:red}{y}",
        r"\frac{",
        "x" * 5000,
        "",
    ],
)
def test_what_does_more_than_typeset_is_refused(latex: str) -> None:
    found = mathml(latex) or ""
    assert not any(word in found for word in ("script", "stolen", "href", "style=", "class="))


def test_a_sign_that_markup_needs_is_escaped() -> None:
    found = mathml(r"a < b \& c")
    assert found is not None
    assert "&lt;" in found
