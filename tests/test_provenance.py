"""What made a number: found from imports, and by what can change it alone."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import uqfold
from uqfold.provenance import PACKAGE, changed_parts, made_by, shown_command, source_digest

METHOD = "from uqfold.methods import Kriging\nfrom uqfold.problems import series\n"
FRAME = [room for room in ("cli", "report", "plots") if (PACKAGE / room).is_dir()]
Edit = Callable[[str], str]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    copy = tmp_path_factory.mktemp("copy") / "uqfold"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    return copy


@pytest.fixture
def case(tmp_path: Path) -> Path:
    folder = tmp_path / "validation" / "a_case"
    folder.mkdir(parents=True)
    return folder


def digest(case: Path, source: str, package: Path = PACKAGE) -> dict[str, str]:
    (case / "measure.py").write_text(source, encoding="utf-8")
    return source_digest(case, package=package)


def edited(package: Path, file: str, edit: Edit, case: Path, source: str) -> tuple[str, ...]:
    """Return the parts that change as a file of the package is edited."""
    before = digest(case, source, package)
    path = package / file
    kept = path.read_text(encoding="utf-8") if path.exists() else None
    path.write_text(edit(kept or ""), encoding="utf-8")
    try:
        return changed_parts(before, digest(case, source, package))
    finally:
        path.unlink() if kept is None else path.write_text(kept, encoding="utf-8")


def with_line(text: str) -> str:
    return f"{text}\n_CHANGED = 1\n"


def test_only_what_is_imported_counts(case: Path) -> None:
    own = "validation/a_case"
    assert set(digest(case, "import math\n")) == {own}
    assert set(digest(case, "from uqfold.mechanism import WingParameters\n")) == {
        own,
        "uqfold/mechanism",
    }
    everything = digest(case, "from uqfold.methods import available\n")
    assert {"uqfold/methods", "uqfold/system", "uqfold/surrogates"} <= set(everything)
    # within a function it counts as well, for types only it does not
    assert "uqfold/methods" in digest(case, "def f():\n    from uqfold.methods import Kriging\n")
    for_types = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import uqfold.methods\n"
    assert set(digest(case, for_types)) == {own}


@pytest.mark.parametrize(
    "source",
    [
        "import uqfold\nuqfold.methods.Kriging().estimate(uqfold.problems.series())\n",
        "import uqfold as uq\nuq.compare(uq.problems.series(), ['kriging'])\n",
        "from uqfold import methods, problems\nmethods.build('kriging'), problems.series()\n",
        "from .other import build, series\nbuild('kriging'), series()\n",
        METHOD,
    ],
)
def test_every_way_to_name_a_method_is_followed(case: Path, package: Path, source: str) -> None:
    other = "from uqfold.methods import build\nfrom uqfold.problems import series\n"
    (case / "other.py").write_text(other, encoding="utf-8")
    for file in ("methods/kriging.py", "surrogates/gaussian_process.py", "problems/criterion.py"):
        assert edited(package, file, with_line, case, source) == (f"uqfold/{Path(file).parent}",)
    for file in ("methods/ffni_pearson.py", "methods/openturns_form.py", "problems/wing.py"):
        assert edited(package, file, with_line, case, source) == ()


def test_editing_a_plot_or_a_help_text_makes_no_measurement_stale(
    case: Path, package: Path
) -> None:
    everything = "import uqfold\nuqfold.methods.available()\nuqfold.problems.folding_wing()\n"
    before = digest(case, everything, package)
    drawn = [path for room in FRAME for path in (package / room).rglob("*.py")]
    assert drawn
    for path in drawn:
        path.write_text(with_line(path.read_text(encoding="utf-8")), encoding="utf-8")
    assert digest(case, everything, package) == before
    for edit in (
        lambda text: text.replace('"""', '"""What it does, in other words.\n\n', 1),
        lambda text: "# a remark\n\n" + text,
        lambda text: re.sub(r"(?m)^(    def _?\w+\(self.*:)$", r"\1  # a remark", text),
        lambda text: text.replace('str] = "Kriging"', 'str] = "Kriging, in other words"'),
        lambda text: text.replace("[Theory] = KRIGING", '[Theory] = Theory(\n"why", "how"\n)'),
    ):
        kriging = (package / "methods/kriging.py").read_text(encoding="utf-8")
        assert edit(kriging) != kriging
        assert edited(package, "methods/kriging.py", edit, case, METHOD) == ()
    assert edited(
        package,
        "methods/kriging.py",
        lambda text: text.replace("spread: float = 2.0", "spread: float = 1.9"),
        case,
        METHOD,
    ) == ("uqfold/methods",)


def test_no_room_that_draws_counts_for_any_other(package: Path) -> None:
    rooms = [path.name for path in package.iterdir() if (path / "__init__.py").exists()]
    computing = [f"uqfold.{room}" for room in rooms if room not in FRAME]
    parts = source_digest(*computing)
    assert not {f"uqfold/{room}" for room in FRAME} & set(parts)


def test_a_new_method_makes_only_records_of_all_methods_stale(case: Path, package: Path) -> None:
    def registered(text: str) -> str:
        line = '    "new": "uqfold.methods.new:New",\n'
        return text.replace('    "mc": ', f'{line}    "mc": ', 1)

    asks_all = "from uqfold.methods import available\nfound = available()\n"
    by_name = "from uqfold.methods import build\nfound = build('mc')\n"
    method = package / "methods" / "new.py"
    method.write_text("from uqfold.methods.base import ReliabilityMethod\n", encoding="utf-8")
    registry = "methods/registry.py"
    try:
        assert registered((package / registry).read_text()) != (package / registry).read_text()
        assert edited(package, registry, registered, case, METHOD) == ()
        assert edited(package, registry, registered, case, by_name) == ()
        assert edited(package, registry, registered, case, asks_all) == ("uqfold/methods",)
    finally:
        method.unlink()


def test_references_count_with_their_problem(case: Path, package: Path) -> None:
    data = "problems/references/series.json"
    other = "problems/references/four_branch.json"
    assert edited(package, data, lambda text: text + "\n", case, METHOD) == ("uqfold/problems",)
    assert edited(package, other, lambda text: text + "\n", case, METHOD) == ()


def test_code_and_data_beside_a_case_count_by_their_folder(case: Path) -> None:
    before = digest(case, "import math\n")
    helper = case.parent / "shared" / "helper.py"
    helper.parent.mkdir()
    helper.write_text("x = 1\n", encoding="utf-8")
    uses = "from validation.shared.helper import x\n"
    with_helper = digest(case, uses)
    shared, own = "validation/shared", "validation/a_case"
    assert changed_parts(before, with_helper) == (own, shared)
    helper.write_text("x = 2\n", encoding="utf-8")
    assert changed_parts(with_helper, digest(case, uses)) == (shared,)
    (case / "times.csv").write_text("1", encoding="utf-8")
    with_data = source_digest(case)
    assert changed_parts(digest(case, uses), with_data) == ()
    (case / "times.csv").write_text("2", encoding="utf-8")
    assert changed_parts(with_data, source_digest(case)) == (own,)
    assert set(source_digest(case, without=["uqfold.methods"])) == {own, shared}


def test_a_class_stands_for_its_module_and_an_installed_package_for_its_version() -> None:
    assert source_digest(uqfold.methods.Kriging) == source_digest("uqfold.methods.kriging")
    assert source_digest("numpy") == source_digest("a_module_that_is_missing") == {}


def test_what_made_a_number_is_said_without_naming_this_machine(case: Path) -> None:
    (case / "measure.py").write_text(METHOD, encoding="utf-8")
    made = made_by(case, seed=3, settings={"nodes": 5}, command="uqfold compare series")
    assert made["seed"] == 3
    assert made["settings"] == {"nodes": 5}
    assert made["versions"]["uqfold"] == uqfold.__version__
    assert made["source"] == source_digest(case)
    assert str(case.parents[1]) not in repr(made)
    assert shown_command(["uqfold", "--out=/a/b c"]) == "uqfold '--out=.../b c'"


def test_what_a_kept_deployment_time_depends_on_is_found_from_imports(
    package: Path, case: Path
) -> None:
    """One provenance: the folding wing's version in a store is not a digest of its own."""
    source = "import uqfold.problems.deployment_time\n"
    parts = {
        "mechanism/contact.py": ("uqfold/mechanism",),
        "problems/deployment_time.py": ("uqfold/problems",),
        # neither the table of means, nor what only draws a motion, nor a comment
        "problems/wing.py": (),
        "mechanism/tabulation.py": (),
    }
    for file, changed in parts.items():
        assert edited(package, file, with_line, case, source) == changed, file
    commented = edited(package, "mechanism/contact.py", lambda text: f"# why\n{text}", case, source)
    assert commented == ()
