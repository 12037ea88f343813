"""The paper's claims: what turns each of them, and what their findings say.

The results are the committed ones, of which all claims but two hold.
"""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import pytest

from uqfold.validation import Claim, Finding, Verdict, verdict_of
from uqfold.validation.case import Fault, load_cases
from uqfold.validation.runner import sources
from validation.paper.faults import FAULTS, plant
from validation.paper.measure import CLAIMS, judge
from validation.paper.results import IDENTITY, read_results

[CASE] = load_cases(Path(__file__).resolve().parents[2] / "validation" / "paper")
Results = dict[str, pd.DataFrame]


@dataclass(frozen=True)
class Judged:
    """A claim with what was found."""

    claim: Claim
    findings: list[Finding]

    @property
    def verdict(self) -> Verdict:
        return verdict_of(self.findings)


def judged(key: str, results: Results) -> Judged:
    return Judged(*judge(key, results))


@pytest.fixture(scope="module")
def committed() -> Results:
    return read_results()


@pytest.fixture(scope="module")
def found(committed: Results) -> dict[str, Judged]:
    """Every claim as the committed results give it."""
    return {key: judged(key, committed) for key in CLAIMS}


def swapped(study: str, table: str) -> Callable[[Results], None]:
    """Let the two conditions of a table change places."""

    def change(results: Results) -> None:
        frame = results[f"{study}/{table}"]
        one, other = frame["problem"].unique()
        frame["problem"] = frame["problem"].map({one: other, other: one})

    return change


@pytest.mark.parametrize("fault", CASE.faults, ids=lambda fault: fault.name)
def test_a_fault_turns_every_claim_that_it_is_aimed_at(fault: Fault, committed: Results) -> None:
    results = {name: plant(fault.name, table) for name, table in committed.items()}
    verdicts = {key: judged(key, results).verdict for key in fault.claims}
    assert set(verdicts.values()) == {fault.turns_to}, verdicts


def test_every_claim_is_aimed_at_and_every_fault_is_planted() -> None:
    assert {key for fault in CASE.faults for key in fault.claims} == set(CLAIMS)
    assert {fault.name for fault in CASE.faults} == set(FAULTS)


@pytest.mark.parametrize(
    ("key", "table", "rows", "pf"),
    [
        ("agreement", "example-2/no-sync-open", "missions == '2' and 0.2 < pf < 0.8", 0.1),
        ("missions", "example-6/no-sync", "missions == '5' and threshold == 0.365", 0.01),
        ("tau", "example-1/sync", "tau == 20 and threshold == 4", 0.9),
        ("gain of tau", "example-4/delta-sync", "tau == 0.035 and threshold == 0.6", 0.9),
        ("closing gap", "example-6/sync", "tau == 0.03 and missions == '5'", 0.9),
    ],
)
def test_a_few_wrong_rows_break_a_claim(
    key: str, table: str, rows: str, pf: float, committed: Results, found: dict[str, Judged]
) -> None:
    wrong = committed[table].copy()
    places = wrong.query(rows).index
    assert 0 < len(places) < 0.2 * len(wrong)
    wrong.loc[places, ["pf", "reliability"]] = pf, 1.0 - pf
    assert found[key].verdict == "holds"
    assert judged(key, {**committed, table: wrong}).verdict == "does not hold"


def test_simulation_alone_can_contradict_the_plateau(committed: Results) -> None:
    results = copy.deepcopy(committed)
    swapped("example-4", "delta-plateau")(results)
    assert judged("means, plateau, delta", results).verdict == "does not hold"


@pytest.mark.parametrize("table", ["C_r-no-sync", "k_d-check"])
def test_simulation_alone_can_contradict_the_means(table: str, committed: Results) -> None:
    """Curves and marks are judged apart: either one on the other side breaks the claim."""
    results = copy.deepcopy(committed)
    swapped("example-4", table)(results)
    assert judged("means", results).verdict == "does not hold"


@pytest.mark.parametrize(
    ("key", "study", "table", "column"),
    [
        ("means, plateau, C_r", "example-4", "C_r-sync-scatter", "pf_std"),
        ("deviation of C_r, end", "example-5", "C_r-paired", "std_error"),
        ("deviation of C_r, tau", "example-5", "C_r-sync-paired", "std_error"),
    ],
)
def test_errors_as_large_as_the_effect_leave_a_claim_open(
    key: str, study: str, table: str, column: str, committed: Results
) -> None:
    results = copy.deepcopy(committed)
    assert judged(key, results).verdict == "holds"
    results[f"{study}/{table}"][column] = 1.0
    assert judged(key, results).verdict == "cannot be judged"


def test_paired_runs_judge_the_deviation_of_the_clearance(found: dict[str, Judged]) -> None:
    """Five nodes gave the gain at T = 0.57 s the other sign, and nothing to judge it by."""
    gains = {one.what: one for one in found["deviation of C_r, end"].findings}
    for m, low, high in ((2, 3e-6, 7e-6), (10, 1.5e-5, 3.5e-5)):
        gain = gains[f"lead of the smaller deviation at T = 0.57 s, m = {m}"]
        assert gain.value is not None
        assert gain.uncertainty is not None
        assert low < gain.value < high
        assert gain.uncertainty < 0.3 * gain.value


def test_missions_that_the_text_does_not_name_are_quoted_apart(found: dict[str, Judged]) -> None:
    for key in ("agreement", "errors"):
        findings = found[key].findings
        ours = [one for one in findings if one.what.endswith("example-1, m = 3, 8, 10")]
        assert ours
        assert all(one.verdict is None for one in ours)
        assert any("that the text does not name" in one.remark for one in ours)
        assert [one.what for one in findings if one.what.endswith("example-1, m = 1, 2, 5")]


def test_one_yardstick_for_lag_and_trough(found: dict[str, Judged]) -> None:
    """A lag of 1e-18 counts by the letter, as a lag and as a trough, and in no figure."""
    lag, trough = found["deviations"], found["deviations, pattern"]
    assert lag.verdict == trough.verdict == "holds"
    assert "-1.6e-18" in str(lag.findings)
    assert "-1.6e-18" in str(trough.findings)
    assert found["deviations, visible"].verdict == "does not hold"


def test_identities_are_no_evidence(found: dict[str, Judged]) -> None:
    alone = [key for key, one in found.items() if one.claim.identity]
    assert alone == ["missions"]
    for key, what in (
        ("random missions", "largest rise of R"),
        ("tau", "largest fall of R"),
        ("independence", "smallest R less R"),
    ):
        marked = [
            one.what for one in found[key].findings
            if one.remark.startswith(IDENTITY)
        ]  # fmt: skip
        assert marked
        assert all(one.startswith(what) for one in marked)


def test_independence_says_that_its_range_is_ours(found: dict[str, Judged]) -> None:
    independence = found["independence"]
    assert "our restriction" in independence.claim.statement
    everywhere = [
        one for one in independence.findings if one.what.startswith("the same over all T")
    ]
    assert [one.verdict for one in everywhere] == [None, None]
    assert all(one.value is not None and one.value > 0.01 for one in everywhere)


def test_the_table_of_claims_counts_as_what_the_record_was_made_of() -> None:
    """Limits that change make the kept record old, as code that changes does."""
    names = [path.name for path in sources(CASE)]
    assert "claims.toml" in names
    assert "case.toml" not in names


def test_a_missing_table_is_named() -> None:
    with pytest.raises(KeyError, match="example-6/sync"):
        judge("closing gap", {})


def test_contradictions_and_remedies_change_what_they_say() -> None:
    table = pd.DataFrame(
        {
            "problem": ["condition-15", "condition-16"] * 2,
            "missions": ["1"] * 4,
            "threshold": [0.5, 0.5, 0.6, 0.6],
            "tau": [0.03, 0.03, 0.04, 0.04],
            "pf": [0.9, 0.9, 0.1, 0.2],
            "reference_pf": [0.8, float("nan"), 0.1, 0.2],
            "error": [0.125, float("nan"), 0.0, 0.0],
            "n_evals": [75] * 4,
            "difference": [1e-4] * 4,
        }
    )
    before = table.copy()
    after = {name: plant(name, table) for name in FAULTS}
    pd.testing.assert_frame_equal(table, before)
    assert after["upside down"]["pf"].tolist() == [1 - pf for pf in (0.9, 0.9, 0.1, 0.2)]
    assert after["conditions swapped"]["problem"].tolist() == ["condition-16", "condition-15"] * 2
    assert after["tau swapped"]["tau"].tolist() == [0.04, 0.04, 0.03, 0.03]
    assert after["off"]["pf"].tolist() == pytest.approx([0.9, 0.9, 0.13, 0.23])
    assert after["one run more"]["n_evals"].tolist() == [76] * 4
    assert after["paired the other way"]["difference"].tolist() == pytest.approx([-0.01] * 4)
    assert after["troughs"]["pf"].tolist() == pytest.approx([0.9, 0.898, 0.1, 0.098])
    assert after["much later"]["threshold"].tolist() == pytest.approx([0.7, 0.7, 0.8, 0.8])
    assert after["later"]["threshold"].tolist() == pytest.approx([0.585, 0.585, 0.685, 0.685])


def test_verdicts_on_the_paper(found: dict[str, Judged]) -> None:
    verdicts = {key: one.verdict for key, one in found.items()}
    failing = [key for key, verdict in verdicts.items() if verdict != "holds"]
    assert len(verdicts) == 25
    assert failing == ["deviations, visible", "range of T, onset"]
    assert {verdicts[key] for key in failing} == {"does not hold"}
