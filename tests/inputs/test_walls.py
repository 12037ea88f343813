"""OpenTURNS stays behind its walls: a new module that touches it is refused by default."""

import re
import tomllib
from pathlib import Path

import openturns as ot
import pytest

import uqfold
from uqfold.inputs import joint_inputs, product_inputs

TOP = Path(uqfold.__file__).parents[1]
TOUCHED = r"\.(getSample|getMarginal|getDimension|getMean|getClassName|getCopula|computeCDF)\("


@pytest.mark.parametrize("planted", ["uqfold.analysis.sobol", "uqfold.methods.monte_carlo"])
@pytest.mark.parametrize("protected", ["openturns", "uqfold.inputs.engine", "chaospy"])
def test_a_planted_import_breaks_the_contract(planted: str, protected: str) -> None:
    grimp = pytest.importorskip("grimp")
    protection = pytest.importorskip("importlinter.contracts.protected")
    contracts = tomllib.loads((TOP / "pyproject.toml").read_text())["tool"]["importlinter"]
    [options] = [
        one for one in contracts["contracts"] if one.get("protected_modules") == [protected]
    ]
    contract = protection.ProtectedContract(options["name"], {}, options)
    graph = grimp.ImportGraph()
    for module in (protected, planted, "uqfold.inputs", *options["allowed_importers"]):
        graph.add_module(module)
    graph.add_import(importer=options["allowed_importers"][0], imported=protected)
    assert contract.check(graph, verbose=False).kept
    graph.add_import(importer=planted, imported=protected)
    assert not contract.check(graph, verbose=False).kept


def test_nothing_outside_touches_openturns_objects_by_duck_typing() -> None:
    sources = [*TOP.glob("uqfold/**/*.py"), *TOP.glob("studies/**/*.py")]
    found = [
        str(path.relative_to(TOP))
        for path in sources
        if path.parent.name != "inputs"
        and not path.name.startswith("openturns_")
        and re.search(TOUCHED, path.read_text())
    ]
    assert found == []
    assert re.search(TOUCHED, (TOP / "uqfold/inputs/joint.py").read_text())  # it can fail


def test_inputs_say_families_and_dependence_themselves() -> None:
    assert product_inputs(None, [ot.Normal(), ot.Gumbel()]).families == ("Normal", "Gumbel")
    assert product_inputs(None, [ot.Normal(), ot.Gumbel()]).dependence == "independent"
    joint = ot.JointDistribution([ot.Normal(), ot.Gumbel()], ot.ClaytonCopula(2.0))
    assert joint_inputs(joint).dependence == "ClaytonCopula"
