"""The pages: every method has one, every public name is listed once, links lead somewhere."""

import importlib
import re
import sys
from collections import Counter
from dataclasses import fields
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import uqfold
from uqfold.methods.registry import built_in

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [
    *DOCS.glob("*.md"), *DOCS.glob("methods/*.md"), *DOCS.glob("api/*.md"), ROOT / "README.md"
]  # fmt: skip
sys.path.append(str(DOCS / "extensions"))
method_pages = importlib.import_module("method_pages")
reports_made = importlib.import_module("reports_made")


@pytest.mark.parametrize("name", built_in())
def test_every_method_has_a_page_with_idea_settings_and_references(name: str) -> None:
    page = (DOCS / "methods" / f"{name}.md").read_text(encoding="utf-8")
    made = method_pages.filled(name, page)
    assert made.startswith("# ")
    assert f"`{name}`" in made.splitlines()[0]
    for heading in ("## When", "## When not", "## Cost", "## Settings"):
        assert made.count(f"\n{heading}\n") == 1
    method = uqfold.methods.available()[name]
    assert re.findall(r"^\| `(\w+)` \|", made, re.M) == [one.name for one in fields(method)]
    assert made.count("```{math}") == len(method.theory.equations)


def test_a_page_that_does_not_say_when_not_is_refused() -> None:
    with pytest.raises(ValueError, match="## When not"):
        method_pages.filled("mc", "# Monte Carlo: `mc`\n\n## When\n\n## Cost\n")


def listed(text: str) -> list[tuple[str, int]]:
    """Name and object of everything that a page takes from its modules."""
    found = [
        (name, id(getattr(importlib.import_module(module), name)))
        for module, name in re.findall(r"\.\. autoclass:: (\S+)\.(\w+)\n", text)
    ]
    for module, options in re.findall(r"\.\. automodule:: (\S+)\n((?:   .*\n)*)", text):
        package = importlib.import_module(module)
        left_out = re.findall(r"\w+", "".join(re.findall(r":exclude-members:(.*)", options)))
        for name in set(package.__all__) - set(left_out):
            if not isinstance(getattr(package, name), ModuleType):
                found.append((name, id(getattr(package, name))))
    return found


def test_every_public_name_is_on_one_page_of_the_interface_once() -> None:
    pages = [path.read_text(encoding="utf-8") for path in DOCS.glob("api/*.md")]
    found = Counter(one for page in pages for one in listed(page))
    rooms = [uqfold, uqfold.problems.catalogue]
    rooms += [
        one for one in map(uqfold.__dict__.get, uqfold.__all__) if isinstance(one, ModuleType)
    ]
    public = {
        (name, id(getattr(room, name)))
        for room in rooms
        for name in room.__all__
        if not isinstance(getattr(room, name), ModuleType)
    }
    assert len(public) > 100
    assert found == Counter(public)


def linked(page: Path) -> list[str]:
    """Files that a page links to, but for addresses in the network."""
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    targets = re.findall(r"\]\(([^)#\s]+)(?:#[^)\s]*)?\)", text)
    return [one for one in targets if "://" not in one]


def test_links_between_pages_lead_somewhere() -> None:
    broken = [
        f"{page.name}: {target}"
        for page in PAGES
        for target in linked(page)
        if not (page.parent / target).exists()
    ]
    assert broken == []
    assert sum(len(linked(page)) for page in PAGES) > 100


def test_the_paper_is_cited_in_full_where_it_is_named() -> None:
    citation = reports_made.cited(DOCS)
    assert citation.startswith("Reliability assessment of folding wing system deployment")
    app = SimpleNamespace(srcdir=DOCS)
    pages = ["The paper says so.", "Paper is patient.", "See [it](../../studies/a/report.md)."]
    sources = [[page] for page in pages]
    for source in sources:
        reports_made._changed(app, "methods/mc", source)
    assert sources[0][0].endswith(f"*[The paper](../paper.md)*: {citation}\n")
    assert sources[1:] == [[pages[1]], ["See [it](../made/studies/a/report.md)."]]


def test_reports_are_copied_with_their_figures_and_anchors(tmp_path: Path) -> None:
    for place in ("studies/one/figures", "validation", "docs"):
        (tmp_path / place).mkdir(parents=True)
    (tmp_path / "studies/one/figures/a.png").touch()
    for place in ("studies/one", "validation"):
        (tmp_path / place / "report.md").write_text('# Report\n\n<a id="case-x"></a>\n')
    reports_made.copied(tmp_path / "docs")
    reports_made.copied(tmp_path / "docs")
    made = tmp_path / "docs/made"
    assert (made / "studies/one/figures/a.png").is_file()
    assert (made / "validation/report.md").read_text().endswith("# Report\n\n(case-x)=\n")
