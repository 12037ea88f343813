"""The case on false confidence: its problems, a run that was interrupted, and the page on it."""

import json
import runpy
from pathlib import Path

from validation.no_false_confidence.measure import QUICK, KeptAnswers
from validation.no_false_confidence.problems import PROBLEMS

ROOT = Path(__file__).parents[2]


def test_the_page_is_that_of_the_kept_record() -> None:
    """``docs/no_false_confidence.md`` tells the record, and a check notices when it does not."""
    page = runpy.run_path(str(ROOT / "docs" / "no_false_confidence.py"))
    assert page["main"](["--check"]) == 0, "run python docs/no_false_confidence.py"
    text = page["PAGE"].read_text(encoding="utf-8")
    assert f"| {len(page['kept']().measurement.tables[1].rows)} | quoted only |" in text


def test_there_are_enough_problems_of_every_kind() -> None:
    """At least sixty, in 1 to 100 inputs, with pf from 0.9 to 1e-8."""
    names = [hard.name for hard in PROBLEMS]
    assert len(set(names)) == len(names) >= 60
    assert set(QUICK) < set(names)
    assert {1, 2, 4, 10, 30, 50, 100} <= {hard.d for hard in PROBLEMS}
    quick = [hard.pf for hard in PROBLEMS if hard.d <= 2]
    assert min(quick) < 1.1e-8
    assert max(quick) > 0.9


def test_an_interrupted_run_goes_on_where_it_ended(tmp_path: Path) -> None:
    """Each answer of the same code is kept, half a line is not, nor what other code answered."""
    kept, code = tmp_path / "kept.jsonl", {"a": "1"}
    row = {"problem": "p", "method": "m", "seed": 0, "pf": 0.1, "std_error": float("nan")}
    begun = "".join(json.dumps(one) + "\n" for one in (code, row))
    kept.write_text(begun + json.dumps(dict(row, seed=1))[:-9])
    with KeptAnswers({"p": [("p", "m", 0)]}, kept, code) as answers:
        assert answers.to("p")["pf"].tolist() == [0.1]
        assert list(answers.known) == [("p", "m", 0)]
    assert kept.read_text() == begun
    with KeptAnswers({}, kept, {"a": "2"}) as answers:
        assert answers.known == {}
