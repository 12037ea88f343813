"""What pages say of the paper agrees with the record of its claims, and from page to page."""

import json
import math
import re
import tomllib
from pathlib import Path

from validation.paper.accuracy import RUNS

ROOT = Path(__file__).parents[2]
PAPER = ROOT / "validation" / "paper"
SAID = {
    "deviations, visible": "sizes",
    "range of T, onset": "the onset of the plateau in Example 6",
}
"""Claim that does not hold -> how the choice of the start pose speaks of it."""
SIZE = 2_000_000
"""Sample size of the Monte Carlo in Tables 3 and 7."""
UNITS, MOST_MISSIONS = 4, 10


def test_the_package_knows_no_example_condition_or_claim_of_the_paper() -> None:
    # but for the versions of two models, by which stores and sessions of earlier releases know them
    version = r'(?<!version=")(?<!version=f")'
    told = re.compile(version + r"[Ee]xample[ -][1-6]\b|[Cc]ondition[ -]\d|[Ff]igure \d|Fig\. \d")
    files = [
        path for kind in ("py", "pyi", "json") for path in (ROOT / "uqfold").rglob(f"*.{kind}")
    ]
    # the catalogue cites examples of others
    own = [path for path in files if "catalogue" not in path.parts]
    assert [str(path) for path in own if told.search(path.read_text(encoding="utf-8"))] == []
    assert told.search((PAPER / "means.py").read_text(encoding="utf-8"))


def test_the_start_pose_is_said_to_give_what_the_record_gives() -> None:
    """It was said to reproduce every sign, whatever the claims came to."""
    page = (ROOT / "docs" / "mechanism.md").read_text(encoding="utf-8")
    [row] = [line for line in page.splitlines() if line.startswith("| start |")]
    verdicts = json.loads((PAPER / "full.json").read_text(encoding="utf-8"))["claims"]
    assert {key for key, verdict in verdicts.items() if verdict != "holds"} == set(SAID)
    missing = re.search(r"as far as they can be judged, (.*) do not", row)
    assert missing is not None
    assert all(words in missing[1] for words in SAID.values())
    assert "every sign" not in row


def test_sample_sizes_of_the_paper_are_numbers_of_evaluations_everywhere() -> None:
    """They were read as systems in one place and as deployments in another."""
    claims = tomllib.loads((PAPER / "claims.toml").read_text(encoding="utf-8"))["claim"]
    [errors] = [claim for claim in claims if claim["key"] == "errors"]
    rule = " ".join(errors["rule"].split())
    assert "if its sample sizes are numbers of evaluations" in rule
    worst, best = (
        math.sqrt((1.0 - seen) / (seen * SIZE / (UNITS * missions)))
        for seen in [errors["given"]["seen"]]
        for missions in (MOST_MISSIONS, 1)
    )
    assert f"resolves to {100 * best:.0f} to {100 * worst:.0f} %" in rule
    study = (ROOT / "studies" / "example-3" / "report.md").read_text(encoding="utf-8")
    assert (
        f"Sizes are model runs (deployments), and so we read those of the paper: {SIZE:,}" in study
    )
    assert f"{RUNS['example-3']:,} for its methods" in study
    pages = [
        ROOT / "README.md",
        *(ROOT / "docs").glob("*.md"),
        *(ROOT / "studies").glob("*/report.md"),
        *(ROOT / "validation").glob("*/*.toml"),
        *PAPER.glob("*.py"),
    ]
    as_systems = (
        r"paper's\b[^.]*\b(2e6|2 million|2,000,000|500,000) systems|\d systems of the paper"
    )
    for page in pages:
        text = " ".join(page.read_text(encoding="utf-8").split())
        assert re.search(as_systems, text) is None, page
