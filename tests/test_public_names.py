"""What packages hand out: every name works, is written once, and is known to type checkers."""

import os
from importlib import import_module
from pathlib import Path

import pytest

import uqfold

ROOT = Path(__file__).parents[1]
PACKAGES = [
    "uqfold", "uqfold.analysis", "uqfold.comparison", "uqfold.evaluation", "uqfold.inputs",
    "uqfold.mechanism", "uqfold.methods", "uqfold.plots", "uqfold.problems", "uqfold.report",
    "uqfold.testing", "uqfold.validation",
]  # fmt: skip


@pytest.mark.parametrize("name", PACKAGES)
def test_a_package_hands_out_its_names_and_nothing_else(name: str) -> None:
    """``__all__`` and ``dir`` hold what people need; every name works, and is written once."""
    package = import_module(name)
    assert dir(package) == sorted(package.__all__) == sorted(set(package.__all__))
    for one in package.__all__:
        assert not one.startswith("_")
        assert getattr(package, one) is not None
    assert package.__doc__
    text = Path(str(package.__file__)).read_text(encoding="utf-8")
    assert [one for one in package.__all__ if f'"{one}"' in text] == []
    with pytest.raises(AttributeError, match="no attribute 'Krigin'"):
        package.Krigin  # noqa: B018


def test_the_rooms_that_messages_name_are_reachable() -> None:
    rooms = {"analysis", "comparison", "evaluation", "methods", "plots", "problems", "validation"}
    assert rooms <= set(uqfold.__all__)
    assert uqfold.evaluation.Processes
    assert {path.parent.name for path in ROOT.glob("uqfold/*/__init__.pyi")} == {
        name.removeprefix("uqfold.") for name in PACKAGES[1:]
    }


def test_a_name_that_has_moved_warns_for_one_release() -> None:
    for former, name in (("Case", "NamedProblem"), ("named_case", "named_problem")):
        with pytest.warns(DeprecationWarning, match=f"uqfold.comparison.{name} now"):
            assert getattr(uqfold.comparison, former) is getattr(uqfold.comparison, name)
        assert former not in dir(uqfold.comparison)


def test_a_type_checker_sees_a_misspelt_method(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``uqfold.methods.Krigin()`` passed mypy."""
    mypy = pytest.importorskip("mypy.api")
    # what is handed out is in the stubs alone, which are read in a second
    for stub in ROOT.glob("uqfold/**/__init__.pyi"):
        copy = tmp_path / stub.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(stub.read_bytes())
    # and in this folder the whole package would be
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "script.py"
    uses = "methods.Kriging", "methods.Krigin", "problems.series", "problems.serie"
    script.write_text("\n".join(["import uqfold", *(f"uqfold.{use}" for use in uses)]))
    options = "--config-file=", "--ignore-missing-imports", "--no-site-packages"
    found, _, _ = mypy.run([*options, f"--cache-dir={os.devnull}", str(script)])
    assert [line for line in found.splitlines() if 'has no attribute "Krigin"' in line], found
    assert [line for line in found.splitlines() if 'has no attribute "serie"' in line], found
    assert found.count("error:") == 2, found
