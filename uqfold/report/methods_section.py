"""The methods section of a report, generated from what was run, fit for the appendix of a paper."""

from __future__ import annotations

from collections.abc import Mapping
from math import isnan
from typing import TYPE_CHECKING, Any

from uqfold.comparison.columns import ATTRIBUTE
from uqfold.plots.wording import response_text
from uqfold.problems.criterion import threshold_text
from uqfold.report.page.builder import Page
from uqfold.report.page.markup import literal

if TYPE_CHECKING:
    import pandas as pd

_STRUCTURES = {
    "Series()": "all of which must work",
    "Parallel()": "at least one of which must work",
}
_SHARED = (
    "Shared inputs are drawn once for the whole system and kept over its missions, so that "
    "failures of its units are correlated; individual inputs are drawn for every unit and "
    "every mission."
)
DEFINITION = (
    (
        r"q(v) = \Pr\left\{ \max_i t_i \le T \mid v \right\} = "
        r"\left[ H(T \mid v) \right]^n",
        "With the distribution function H of one unit's response given the shared inputs v, "
        "one mission of n units works with probability",
        "Eqs. (22), (23)",
    ),
    (
        r"q(v) = \Pr\left\{ \max_i t_i \le T, \; \max_i t_i - \min_i t_i \le \tau "
        r"\mid v \right\}",
        "under a synchronization threshold tau one mission works with probability",
        "Eq. (37)",
    ),
    (
        r"p_f = \operatorname{E}_v \left[ 1 - q(v)^m \right]",
        "m missions with the same shared inputs fail with probability",
        "Eqs. (28), (39)",
    ),
    (
        r"p_f = \operatorname{E}_v \left[ 1 - \left( 1 - p + p \, q(v) \right)^N \right]",
        "and, where of N planned missions each is flown with probability p,",
        "Eqs. (30), (40)",
    ),
)
"""How a series system fails: without tau, with tau, over m missions, over a binomial number."""
_POLICIES = {
    "bound": "counted as failures in pf; pf with all of them safe is given beside it",
    "count-as-failure": "counted as failures",
    "raise": "end the comparison",
}


def add_methods(page: Page, frame: pd.DataFrame) -> None:
    """Describe problem, question, every method with its settings, equations and references."""
    header = frame.attrs[ATTRIBUTE]
    methods = header["methods"]
    stated = dict.fromkeys(one for entry in methods for one in entry["theory"]["references"])
    cited = {reference: number for number, reference in enumerate(stated, start=1)}
    page.section("Methods", name="methods")
    page.text(
        "This section is generated from the records: it says what was run, not what might have "
        "been."
    )
    page.section("Problem", level=2, name="problem")
    _add_problem(page, frame)
    page.section("Question", level=2, name="question")
    _add_question(page, frame)
    for number, entry in enumerate(methods, start=1):
        title = f"{entry['label']}: {entry['title']}" if entry["title"] else entry["label"]
        page.section(title, level=2, name=f"method-{number}")
        _add_method(page, entry, cited)
    page.section("References", level=2, name="references")
    listed = [f"{number}. {literal(reference)}" for reference, number in cited.items()]
    page.text("\n".join(listed) or "None is stated.")


def add_reproduction(page: Page, header: Mapping[str, Any]) -> None:
    """Say what makes the same numbers again."""
    page.section("Making it again", name="reproduction")
    if header["command"]:
        page.code(header["command"])
    versions = ", ".join(f"{name} {version}" for name, version in header["versions"].items())
    page.facts(
        {
            "seed of every method": str(header["seed"]),
            "begun": literal(header["date"] or "not recorded"),
            "versions": literal(versions or "not recorded"),
            "machine": literal(header["machine"] or "not recorded"),
        }
    )
    page.text(
        "With the same versions and the same seed every number comes out the same, but for the "
        "times, which belong to the machine.",
        small=True,
    )


def _add_problem(page: Page, frame: pd.DataFrame) -> None:
    import pandas as pd

    header, response = frame.attrs[ATTRIBUTE], response_text(frame)
    system = header["system"]
    if system is None:
        said = f"{header['problem']}{f'; response: {response}' if response else ''}. "
        page.text(literal(said + "Its inputs are not recorded."))
        return
    units = "one unit"
    if system["units"] > 1:
        must = _STRUCTURES.get(system["structure"], f"structure {system['structure']}")
        units = f"{system['units']} units, {must}"
    said = f"{header['problem']}: {units}. "
    if response:
        said += f"The response of a unit is its {response}. "
    if system["units"] > 1 and any(one["role"] == "shared" for one in system["inputs"]):
        said += _SHARED
    if offsets := system.get("offsets"):
        added = ", ".join(f"{value:+g} to that of {name}" for name, value in offsets.items())
        said += f" Units differ: the response gets {added}."
    page.text(literal(said))
    inputs = pd.DataFrame(system["inputs"], columns=["name", "unit", "role", "distribution"])
    inputs["unit"] = inputs["unit"].replace("", "–")
    page.table(inputs.rename(columns={"name": "input"}), "Random inputs")
    if system["dependence"] != "independent":
        page.text(literal(f"The inputs are joined by a copula: {system['dependence']}."))


def _add_question(page: Page, frame: pd.DataFrame) -> None:
    header, unit = frame.attrs[ATTRIBUTE], frame.attrs[ATTRIBUTE]["response_unit"]
    taus = dict.fromkeys("none" if isnan(tau) else f"{tau:g}" for tau in frame["tau"])
    missions = ", ".join(dict.fromkeys(frame["missions"]))
    written = [threshold_text(one).removeprefix("T = ") for one in frame["threshold"]]
    thresholds = ", ".join(dict.fromkeys(written))
    facts = {"threshold T": literal(f"{thresholds} {unit}".strip())}
    if thresholds == "g <= 0":
        facts = {"failure": literal(thresholds)}
    if list(taus) != ["none"]:
        facts["synchronization threshold tau"] = literal(f"{', '.join(taus)} {unit}".strip())
    facts["missions m"] = literal(missions)
    if len(header["criteria"]) > 1:
        facts["criteria in all"] = str(len(header["criteria"]))
    if header["max_evals"] is not None:
        facts["budget of each method"] = f"{header['max_evals']:,} evaluations"
    if header["failed_runs"]:
        policy = _POLICIES.get(header["failed_runs"], header["failed_runs"])
        facts["failed evaluations"] = literal(policy)
    reference = header["reference"]
    facts["reference"] = "none"
    if reference is not None:
        facts["reference"] = literal(f"{reference['kind']}: {reference['how']}")
        if reference["command"]:
            facts["made by"] = literal(reference["command"])
    page.facts(facts)
    system = header["system"]
    if system is not None and system["structure"] == "Series()":
        asked = ("none" in taus, set(taus) != {"none"}, True, "binomial" in missions)
        for applies, equation in zip(asked, DEFINITION, strict=True):
            if applies:
                page.equation(*equation)


def _add_method(page: Page, entry: Mapping[str, Any], cited: Mapping[str, int]) -> None:
    theory = entry["theory"]
    if theory["summary"]:
        page.text(literal(theory["summary"]))
    for one in theory["equations"]:
        page.equation(one["latex"], literal(one["lead"]), one["source"])
    page.code(entry["settings"] or f"{entry['method']}: settings not recorded")
    if theory["references"]:
        numbers = ", ".join(str(cited[one]) for one in theory["references"])
        page.text(f"[References](#references) {numbers}.", small=True)
    if not theory["summary"] and not theory["equations"]:
        page.text("The method states no equations.", small=True)
