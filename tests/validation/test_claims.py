"""Every claim can break: a contradiction planted in the results turns it to "does not hold".

The results are the committed ones. Where they already break a claim, or cannot judge it, they are
first made to agree with it, so that what breaks it afterwards is the planted contradiction alone.
"""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import pytest

from uqfold.validation import Claim, Finding, Verdict, verdict_of
from uqfold.validation.case import load_cases
from uqfold.validation.runner import sources
from validation.paper.faults import FAULTS
from validation.paper.measure import CLAIMS, judge
from validation.paper.results import IDENTITY, read_results

FOLDER = Path(__file__).resolve().parents[2] / "validation" / "paper"
Results = dict[str, pd.DataFrame]
Change = Callable[[Results], None]


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


def set_pf(frame: pd.DataFrame, rows: "pd.Series[bool]", pf: object) -> None:
    frame.loc[rows, "pf"] = pf
    frame.loc[rows, "reliability"] = 1.0 - frame.loc[rows, "pf"]


def swapped(study: str, tables: list[str], late: bool = False) -> Change:
    """Let the two conditions of these tables change places, everywhere or at the largest T."""

    def change(results: Results) -> None:
        for table in tables:
            frame = results[f"{study}/{table}"]
            one, other = frame["problem"].unique()
            rows = frame["threshold"] == frame["threshold"].max() if late else frame.index >= 0
            frame.loc[rows, "problem"] = frame.loc[rows, "problem"].map({one: other, other: one})

    return change


def perfect(results: Results) -> None:
    """Every method hits its reference."""
    for frame in results.values():
        if "reference_pf" in frame:
            known = frame["reference_pf"].notna()
            set_pf(frame, known, frame.loc[known, "reference_pf"])
            frame.loc[known, "error"] = 0.0


def one_row_off(results: Results) -> None:
    frame = results["example-2/no-sync-open"]
    named = frame[frame["missions"] == "2"]
    rows = frame.index == named["reference_pf"].sub(0.5).abs().idxmin()
    set_pf(frame, pd.Series(rows), frame.loc[rows, "reference_pf"] - 0.12)
    frame.loc[rows, "error"] = 0.12 / frame.loc[rows, "reference_pf"]


def one_run_more(results: Results) -> None:
    results["example-6/sync"].loc[3, "n_evals"] += 1


def missions_cross(results: Results) -> None:
    frame = results["example-6/no-sync"]
    rows = (frame["missions"] == "5") & (frame["threshold"] == 0.365)
    set_pf(frame, rows, 0.01)


def planned_cross(results: Results) -> None:
    frame = results["example-3/planned"]
    rows = frame["missions_planned"] == 10
    set_pf(frame, rows, frame.loc[rows, "pf"] * 0.5)


def tau_crosses(results: Results) -> None:
    frame = results["example-1/sync"]
    rows = (frame["tau"] == frame["tau"].max()) & (frame["threshold"] == 4.0)
    set_pf(frame, rows, 0.9)


def gain_grows(results: Results) -> None:
    frame = results["example-4/delta-sync"]
    rows = (frame["tau"] == 0.035) & (frame["threshold"] == frame["threshold"].max())
    set_pf(frame, rows, frame.loc[rows, "pf"] + 0.25)


def tau_does_nothing(results: Results) -> None:
    frame = results["example-3/sync"]
    for _, rows in frame.groupby(["threshold", "missions"]).groups.items():
        set_pf(frame, frame.index.isin(rows), frame.loc[rows, "pf"].mean())


def independence_helps(results: Results) -> None:
    frame = results["example-3/independence"]
    frame.loc[frame["threshold"] == 0.55, "difference"] *= -1.0


def gap_is_small(results: Results) -> None:
    results["example-6/independence"]["difference"] *= 0.1


def patterns_all_alike(results: Results) -> None:
    """Inputs b and k_d get the curves of V_q."""
    for name, pair in (("b", (15, 16)), ("k_d", (17, 18))):
        names = {f"condition-{11 + i}": f"condition-{pair[i]}" for i in range(2)}
        for part in ("no-sync", "sync"):
            rows = results[f"example-5/V_q-{part}"]
            results[f"example-5/{name}-{part}"] = rows.assign(problem=rows["problem"].map(names))


def no_trough(results: Results) -> None:
    frame = results["example-5/V_q-no-sync"]
    early = frame["threshold"] < 0.556
    smaller = early & (frame["problem"] == "condition-11")
    larger = early & (frame["problem"] == "condition-12")
    both = ["pf", "reliability"]
    frame.loc[smaller, both] = frame.loc[larger, both].to_numpy()


def clearance_matters(results: Results) -> None:
    results["example-5/C_r-paired"].loc[4, ["difference", "std_error"]] = -0.02, 1e-4


def paired_the_other_way(*tables: str) -> Change:
    def change(results: Results) -> None:
        for table in tables:
            results[f"example-5/{table}"]["difference"] *= -1.0

    return change


def clear_plateau(results: Results) -> None:
    results["example-4/C_r-sync-scatter"]["pf_std"] = 0.0


def gap_widens(results: Results) -> None:
    frame = results["example-6/sync"]
    rows = (frame["tau"] == frame["tau"].max()) & (frame["missions"] == "5")
    set_pf(frame, rows, 0.9)


def range_of_the_text(results: Results) -> None:
    results["example-6/sync"]["threshold"] += 0.085


def range_of_ours(results: Results) -> None:
    results["example-6/sync"]["threshold"] -= 0.085


def much_later(results: Results) -> None:
    results["example-6/sync"]["threshold"] += 0.2


def as_it_is(_: Results) -> None:
    pass


CASES: dict[str, tuple[Change, Change]] = {
    "agreement": (perfect, one_row_off),
    "errors": (perfect, one_row_off),
    "sample sizes": (as_it_is, one_run_more),
    "missions": (as_it_is, missions_cross),
    "random missions": (as_it_is, planned_cross),
    "tau": (as_it_is, tau_crosses),
    "gain of tau": (as_it_is, gain_grows),
    "T or tau": (as_it_is, tau_does_nothing),
    "independence": (as_it_is, independence_helps),
    "dispersion": (as_it_is, gap_is_small),
    "means": (as_it_is, swapped("example-4", ["C_r-no-sync"])),
    "means, climb": (as_it_is, swapped("example-4", ["b-sync"])),
    "means, plateau": (as_it_is, swapped("example-4", ["k_d-sync"], late=True)),
    "means, plateau, delta": (as_it_is, swapped("example-4", ["delta-sync"], late=True)),
    "means, plateau, C_r": (clear_plateau, swapped("example-4", ["C_r-sync"], late=True)),
    "deviations": (as_it_is, swapped("example-5", ["k_d-no-sync"])),
    "deviations, pattern": (as_it_is, no_trough),
    "deviation of C_r": (as_it_is, clearance_matters),
    "deviation of C_r, end": (as_it_is, paired_the_other_way("C_r-paired")),
    "deviations, tau": (as_it_is, swapped("example-5", ["delta-sync"])),
    "deviations, visible": (patterns_all_alike, no_trough),
    "deviation of C_r, tau": (as_it_is, paired_the_other_way("C_r-sync-paired")),
    "closing gap": (as_it_is, gap_widens),
    "range of T": (as_it_is, much_later),
    "range of T, onset": (range_of_the_text, range_of_ours),
}
"""Claim -> what makes the committed results agree with it, and the contradiction."""


def test_every_claim_has_a_case() -> None:
    assert list(CASES) == list(CLAIMS)


@pytest.mark.parametrize("key", CASES)
def test_a_planted_contradiction_breaks_the_claim(key: str, committed: Results) -> None:
    agree, contradict = CASES[key]
    results = copy.deepcopy(committed)
    agree(results)
    before = judged(key, results)
    assert before.verdict == "holds", [finding.words for finding in before.findings]
    contradict(results)
    assert judged(key, results).verdict == "does not hold"


def test_simulation_alone_can_contradict_the_plateau(committed: Results) -> None:
    results = copy.deepcopy(committed)
    swapped("example-4", ["delta-plateau"])(results)
    assert judged("means, plateau, delta", results).verdict == "does not hold"


@pytest.mark.parametrize("table", ["C_r-no-sync", "k_d-check"])
def test_simulation_alone_can_contradict_the_means(table: str, committed: Results) -> None:
    """Curves and marks are judged apart: either one on the other side breaks the claim."""
    results = copy.deepcopy(committed)
    swapped("example-4", [table])(results)
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


def test_paired_runs_judge_the_deviation_of_the_clearance(committed: Results) -> None:
    """Five nodes gave the gain at T = 0.57 s the other sign, and nothing to judge it by."""
    found = judged("deviation of C_r, end", committed)
    gains = {one.what: one for one in found.findings}
    for m, low, high in ((2, 3e-6, 7e-6), (10, 1.5e-5, 3.5e-5)):
        gain = gains[f"lead of the smaller deviation at T = 0.57 s, m = {m}"]
        assert gain.value is not None
        assert gain.uncertainty is not None
        assert low < gain.value < high
        assert gain.uncertainty < 0.3 * gain.value


def test_missions_that_the_text_does_not_name_are_quoted_apart(committed: Results) -> None:
    for key in ("agreement", "errors"):
        findings = judged(key, committed).findings
        ours = [one for one in findings if one.what.endswith("example-1, m = 3, 8, 10")]
        assert ours
        assert all(one.verdict is None for one in ours)
        assert any("that the text does not name" in one.remark for one in ours)
        assert [one.what for one in findings if one.what.endswith("example-1, m = 1, 2, 5")]


def test_one_yardstick_for_lag_and_trough(committed: Results) -> None:
    """A lag of 1e-18 counts by the letter, as a lag and as a trough, and in no figure."""
    lag = judged("deviations", committed)
    trough = judged("deviations, pattern", committed)
    assert lag.verdict == trough.verdict == "holds"
    assert "-1.6e-18" in str(lag.findings)
    assert "-1.6e-18" in str(trough.findings)
    assert judged("deviations, visible", committed).verdict == "does not hold"


def test_identities_are_no_evidence(committed: Results) -> None:
    alone = [key for key in CLAIMS if judged(key, committed).claim.identity]
    assert alone == ["missions"]
    for key, what in (
        ("random missions", "largest rise of R"),
        ("tau", "largest fall of R"),
        ("independence", "smallest R less R"),
    ):
        marked = [
            one.what for one in judged(key, committed).findings
            if one.remark.startswith(IDENTITY)
        ]  # fmt: skip
        assert marked
        assert all(one.startswith(what) for one in marked)


def test_independence_says_that_its_range_is_ours(committed: Results) -> None:
    found = judged("independence", committed)
    assert "our restriction" in found.claim.statement
    everywhere = [one for one in found.findings if one.what.startswith("the same over all T")]
    assert [one.verdict for one in everywhere] == [None, None]
    assert all(one.value is not None and one.value > 0.01 for one in everywhere)


def test_the_table_of_claims_counts_as_what_the_record_was_made_of() -> None:
    """Limits that change make the kept record old, as code that changes does."""
    [case] = load_cases(FOLDER)
    names = [path.name for path in sources(case)]
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
    after = {name: change(table) for name, change in FAULTS.items()}
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


def test_verdicts_on_the_paper(committed: Results) -> None:
    verdicts = {key: judged(key, committed).verdict for key in CLAIMS}
    failing = [key for key, verdict in verdicts.items() if verdict != "holds"]
    assert len(verdicts) == 25
    assert failing == ["deviations, visible", "range of T, onset"]
    assert {verdicts[key] for key in failing} == {"does not hold"}
