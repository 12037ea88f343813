"""The table of the paper's claims, with verdicts and numbers, in Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from uqfold.comparison.claims import JudgedClaim
from uqfold.comparison.findings import VERDICT_RULE, Finding

COMMAND = "uqfold study claims"


def claims_page(judged: Sequence[JudgedClaim]) -> str:
    """Write the page: a table of verdicts, then every claim with its rule and findings.

    Parameters
    ----------
    judged
        The claims, in the order of the page.
    """
    counts = Counter(one.verdict for one in judged)
    identities = sum(one.identity for one in judged)
    apart = f" ({identities} by identities alone, which are no evidence)" if identities else ""
    summary = (
        f"{counts['holds']} hold{apart}, {counts['does not hold']} do not hold, "
        f"{counts['cannot be judged']} cannot be judged"
    )
    blocks = [
        "# What the paper claims, and what the studies say",
        f"Written by `{COMMAND}` from the results of the studies; nothing here is typed. Of "
        f"{len(judged)} claims: {summary}. {VERDICT_RULE} "
        "A limit within a number's own uncertainty cannot be judged; numbers without a limit are "
        "only quoted.",
        "\n".join(
            [
                "| claim | where | verdict |",
                "| --- | --- | --- |",
                *(
                    f"| [{one.claim.statement}](#{_anchor(one.claim.key)}) | {one.claim.source} | "
                    f"**{one.verdict_words}** |"
                    for one in judged
                ),
            ]
        ),
        *(_section(one) for one in judged),
    ]
    return "\n\n".join(blocks) + "\n"


def _section(one: JudgedClaim) -> str:
    claim = one.claim
    lines = [
        f"## {claim.key}",
        f"{claim.statement} ({claim.source})",
        f"Rule: {claim.rule}. Verdict: **{one.verdict_words}**.",
        "\n".join(f"- {_escaped(finding)}" for finding in one.findings),
    ]
    return "\n\n".join(lines)


def _escaped(finding: Finding) -> str:
    words = finding.words
    for sign in "_*<>|":
        words = words.replace(sign, f"\\{sign}")
    return words


def _anchor(key: str) -> str:
    return key.lower().replace(",", "").replace(".", "").replace(" ", "-")
