"""The paper's claims (`claims.toml`), judged by the committed tables of the studies.

No study is run here; `python studies/<name>/study.py` makes its tables again.
"""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from pkgutil import resolve_name

from uqfold.validation import Claim, Finding, Measurement, Work, verdict_of
from validation.paper.faults import plant
from validation.paper.results import Results, read_results

CLAIMS = {
    one["key"]: one
    for one in tomllib.loads(Path(__file__).with_name("claims.toml").read_text("utf-8"))["claim"]
}
"""Every claim by its key, in the order of the paper."""


def judge(key: str, results: Results) -> tuple[Claim, list[Finding]]:
    """Judge one claim.

    Returns
    -------
    tuple
        The claim, an identity only as long as it holds, and what was found.

    Raises
    ------
    KeyError
        If a table is missing.
    """
    one = CLAIMS[key]
    given = one.get("given", {})
    rule = resolve_name(f"validation.paper.{one['judge']}")
    findings = [replace(finding, claim=key) for finding in rule(results, **given)]
    words = {name: " ".join(one[name].split()) for name in ("statement", "source", "rule")}
    identity = one.get("identity", False) and verdict_of(findings) == "holds"
    formatted = {name: text.format(**given) for name, text in words.items()}
    return Claim(key, **formatted, identity=identity), findings


def measure(work: Work) -> Measurement:
    """Judge all claims; the tiers do not differ."""
    results: Results = read_results()
    if work.fault is not None:
        results = {name: plant(work.fault, table) for name, table in results.items()}
    judged = [judge(key, results) for key in CLAIMS]
    return Measurement(
        [finding for _, findings in judged for finding in findings],
        claims=[claim for claim, _ in judged],
    )
