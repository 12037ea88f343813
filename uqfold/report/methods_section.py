"""The methods section of a report, generated from what was run, fit for the appendix of a paper."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping

from uqfold.comparison.entries import MethodEntry, RunHeader, SystemEntry
from uqfold.comparison.records import Records
from uqfold.problems.criterion import Binomial, Criteria
from uqfold.report.page.blocks import (
    Block,
    Cell,
    Code,
    Column,
    Facts,
    Formula,
    Items,
    Link,
    Listing,
    Paragraph,
    Row,
    Section,
    Table,
    Words,
)
from uqfold.report.wording import quantity

_POLICIES = {
    "bound": "counted as failures in pf; pf with all of them safe is given beside it",
    "count-as-failure": "counted as failures",
    "raise": "end the comparison",
}


def methods_section(records: Records) -> Section:
    """Describe problem, question, every method with its settings, equations and references."""
    header = records.header
    stated = dict.fromkeys(one for entry in header.methods for one in entry.theory.references)
    cited = {reference: number for number, reference in enumerate(stated, start=1)}
    return Section(
        "methods",
        "Methods",
        (
            Paragraph(
                "This section is generated from the records: it says what was run, not what might "
                "have been."
            ),
            Section("problem", "Problem", tuple(_problem(header))),
            Section("question", "Question", tuple(_question(header))),
            *(_method(entry, i, cited) for i, entry in enumerate(header.methods)),
            _references(cited),
        ),
    )


def reproduction_section(header: RunHeader) -> Section:
    """Say what makes the same numbers again."""
    blocks: list[Block] = []
    if header.command:
        blocks.append(Listing(header.command))
    versions = ", ".join(f"{name} {version}" for name, version in header.versions.items())
    facts: list[tuple[str, Words]] = [
        ("seed of every method", str(header.seed)),
        ("begun", header.date or "not recorded"),
        ("versions", versions or "not recorded"),
        ("machine", header.machine or "not recorded"),
    ]
    blocks.append(Facts(tuple(facts)))
    blocks.append(
        Paragraph(
            "With the same versions and the same seed every number comes out the same, but for "
            "the times, which belong to the machine.",
            small=True,
        )
    )
    return Section("reproduction", "Making it again", tuple(blocks))


def _problem(header: RunHeader) -> Iterator[Block]:
    system = header.system
    unit = f" ({header.response_unit})" if header.response_unit else ""
    if system is None:
        yield Paragraph(f"{header.problem}; response: {header.response}{unit}. Its inputs are not "
                        "recorded.")  # fmt: skip
        return
    units = "one unit" if system.units == 1 else f"{system.units} units"
    shared = [one for one in system.inputs if one.role == "shared"]
    said = f"{header.problem}: {units}, {_structure_words(system.structure)}. "
    said += f"The response of a unit is its {header.response}{unit}. "
    if shared and system.units > 1:
        said += (
            "Shared inputs are drawn once for the whole system and kept over its missions, so that "
            "failures of its units are correlated; individual inputs are drawn for every unit and "
            "every mission."
        )
    yield Paragraph(said.strip())
    yield _inputs_table(system)
    if system.dependence != "independent":
        yield Paragraph(f"The inputs are joined by a copula: {system.dependence}.")


def _structure_words(structure: str) -> str:
    known = {
        "Series()": "all of which must work",
        "Parallel()": "at least one of which must work",
    }
    return known.get(structure, f"structure {structure}")


def _inputs_table(system: SystemEntry) -> Table:
    rows = (
        Row((Cell(one.name), Cell(one.unit or "–"), Cell(one.role), Cell([Code(one.distribution)])))
        for one in system.inputs
    )
    heads = ("input", "unit", "role", "distribution")
    return Table("Random inputs", tuple(map(Column, heads)), tuple(rows), tools=False)


def _question(header: RunHeader) -> Iterator[Block]:
    criteria, unit = header.criteria, header.response_unit
    thresholds = _values(dict.fromkeys(one.threshold for one in criteria), unit)
    taus = dict.fromkeys(one.tau for one in criteria if one.tau is not None)
    missions = dict.fromkeys(str(one.missions) for one in criteria)
    facts: list[tuple[str, Words]] = [("threshold T", thresholds)]
    if taus:
        also = "" if all(one.tau is not None for one in criteria) else "none, "
        facts.append(("synchronization threshold tau", also + _values(taus, unit)))
    facts.append(("missions m", ", ".join(missions)))
    facts.append(("criteria in all", str(len(criteria))))
    if header.max_evals is not None:
        facts.append(("budget of each method", f"{header.max_evals:,} evaluations"))
    if header.failed_runs:
        policy = _POLICIES.get(header.failed_runs, header.failed_runs)
        facts.append(("failed model runs", policy))
    reference = header.reference
    if reference is not None:
        facts.append(("reference", f"{reference.kind}: {reference.how}"))
        if reference.command:
            facts.append(("made by", [Code(reference.command)]))
    else:
        facts.append(("reference", "none"))
    yield Facts(tuple(facts))
    yield from _definition(header.system, criteria)


def _values(values: Iterable[float], unit: str) -> str:
    listed = [quantity(value, "") for value in values]
    return f"{', '.join(listed)} {unit}".strip()


def _definition(system: SystemEntry | None, criteria: Criteria) -> Iterator[Block]:
    """Define the failure probability of a series system, as the criteria ask for it."""
    if system is None or system.structure != "Series()":
        return
    synchronized = any(one.tau is not None for one in criteria)
    if any(one.tau is None for one in criteria):
        yield Formula(
            "With the distribution function H of one unit's response given the shared inputs v, "
            "one mission of n units works with probability",
            r"q(v) = \Pr\left\{ \max_i t_i \le T \mid v \right\} = "
            r"\left[ H(T \mid v) \right]^n",
            "Eqs. (22), (23)",
        )
    if synchronized:
        yield Formula(
            "under a synchronization threshold tau one mission works with probability",
            r"q(v) = \Pr\left\{ \max_i t_i \le T, \; \max_i t_i - \min_i t_i \le \tau "
            r"\mid v \right\}",
            "Eq. (37)",
        )
    yield Formula(
        "m missions with the same shared inputs fail with probability",
        r"p_f = \operatorname{E}_v \left[ 1 - q(v)^m \right]",
        "Eqs. (28), (39)",
    )
    if any(isinstance(one.missions, Binomial) for one in criteria):
        yield Formula(
            "and, where of N planned missions each is flown with probability p,",
            r"p_f = \operatorname{E}_v \left[ 1 - \left( 1 - p + p \, q(v) \right)^N \right]",
            "Eqs. (30), (40)",
        )


def _method(entry: MethodEntry, index: int, cited: Mapping[str, int]) -> Section:
    theory = entry.theory
    blocks: list[Block] = []
    if theory.summary:
        blocks.append(Paragraph(theory.summary))
    blocks += [Formula(one.lead, one.latex, one.source) for one in theory.equations]
    blocks.append(_settings(entry))
    if theory.references:
        numbers = ", ".join(str(cited[one]) for one in theory.references)
        blocks.append(Paragraph([Link("References", "references"), f" {numbers}."], small=True))
    if not theory.summary and not theory.equations:
        blocks.append(Paragraph("The method states no equations.", small=True))
    title = f"{entry.label}: {entry.title}" if entry.title else entry.label
    return Section(f"method-{index + 1}", title, tuple(blocks))


def _settings(entry: MethodEntry) -> Block:
    found = parsed_settings(entry.settings)
    if found is None:
        recorded = entry.settings or "not recorded"
        return Facts((("method", [Code(entry.method)]), ("settings", [Code(recorded)])))
    name, settings = found
    facts: list[tuple[str, Words]] = [("class", [Code(name)])]
    facts += [(key, [Code(value)]) for key, value in settings]
    return Facts(tuple(facts))


def parsed_settings(text: str) -> tuple[str, list[tuple[str, str]]] | None:
    """Take a text like ``Name(a=1, b='x')`` apart, without evaluating it; None if it is another.

    Examples
    --------
    >>> parsed_settings("MonteCarlo(systems=None, target_cov=0.1)")
    ('MonteCarlo', [('systems', 'None'), ('target_cov', '0.1')])
    """
    try:
        call = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    if not isinstance(call, ast.Call) or call.args or not isinstance(call.func, ast.Name):
        return None
    settings = []
    for keyword in call.keywords:
        value = ast.get_source_segment(text, keyword.value)
        if keyword.arg is None or value is None:
            return None
        settings.append((keyword.arg, value))
    return call.func.id, settings


def _references(cited: Mapping[str, int]) -> Section:
    said: tuple[Block, ...] = (
        (Items(tuple(cited), numbered=True),) if cited else (Paragraph("None is stated."),)
    )
    return Section("references", "References", said)
