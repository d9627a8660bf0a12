"""The ledger of claims as a table, a page and LaTeX."""

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from neol.base.files import write_atomically
from neol.pictures.labels import three_figures
from neol.study.campaign.grid import cells
from neol.study.claims import claims
from neol.study.claims.claims import Decision, PartVerdict
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.output.captions import describe_budget
from neol.study.output.latex import escape
from neol.study.output.sidecar import write_sidecar


def as_table(decisions: Sequence[Decision]) -> pd.DataFrame:
    """A row for each part of each claim, at full precision."""
    return pd.DataFrame(
        [
            {
                "claim": decision.claim.id,
                "place": decision.claim.place,
                "verdict": decision.verdict,
                "tasks": ",".join(sorted({cell.task for cell in finding.part.cells if cell})),
                "part": finding.part.label,
                "part_verdict": finding.verdict,
                "decisive": finding is decision.decisive,
                "reason": finding.reason,
                "effect": finding.effect,
                "low": finding.low,
                "high": finding.high,
                "p": finding.p,
                "seeds": finding.seeds,
                "seeds_needed": finding.needed,
                "metric": finding.part.metric,
                "unit": finding.part.unit,
            }
            for decision in decisions
            for finding in decision.findings
        ]
    )


def as_markdown(decisions: Sequence[Decision], budget: str) -> str:
    """The ledger as a page: what is decided how, a summary, and each claim with its parts."""
    counts = Counter(decision.verdict for decision in decisions)
    rules = (claims.__doc__ or "").split("\n\n", 1)[1].strip()
    lines = [
        "# The paper's claims",
        f"{budget}",
        f"Of {len(decisions)} claims {counts['supported']} are supported, "
        f"{counts['contradicted']} contradicted and {counts['undecided']} undecided at this "
        "budget.",
        rules,
        "| claim | place | verdict | parts supported | hangs on | effect [95% interval] | n |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n"
        + "\n".join(_markdown_row(decision) for decision in decisions),
    ]
    for decision in decisions:
        lines += _section(decision)
    return "\n\n".join(lines) + "\n"


def as_latex(decisions: Sequence[Decision], budget: str) -> str:
    """The summary as a long table for \\input; it needs the packages booktabs and longtable."""
    head = "Claim & Place & Verdict & Parts & Effect [95\\% interval] & $n$ \\\\"
    rows = []
    for decision in decisions:
        decisive = decision.decisive
        entries = [
            decision.claim.quote,
            decision.claim.place,
            decision.verdict,
            f"{decision.supported}/{len(decision.findings)}",
            _effect(decisive),
            str(decisive.seeds or "--"),
        ]
        rows.append("  " + " & ".join(map(escape, entries)) + " \\\\")
    caption = (
        "The paper's claims, decided on records. Effect: of the part that the verdict hangs on, "
        f"signed so that the claim says above 0. {budget}"
    )
    return "\n".join(
        [
            "\\begingroup\\footnotesize\\setlength{\\tabcolsep}{3pt}",
            "\\begin{longtable}{p{0.47\\linewidth}llcp{0.22\\linewidth}r}",
            f"  \\caption*{{{escape(caption)}}}\\\\",
            "  \\toprule",
            f"  {head}",
            "  \\midrule\\endfirsthead",
            "  \\toprule",
            f"  {head}",
            "  \\midrule\\endhead",
            *rows,
            "  \\bottomrule",
            "\\end{longtable}",
            "\\endgroup",
        ]
    )


def _section(decision: Decision) -> list[str]:
    claim = decision.claim
    lines = [f"## {claim.id}: {decision.verdict}", f"> {claim.quote}\n>\n> ({claim.place})"]
    lines += [f"Reading: {claim.reading}"] if claim.reading else []
    lines += [f"Note: {claim.note}"] if claim.note else []
    rows = [
        f"| {finding.part.label} | {finding.verdict} | {_effect(finding)} | {finding.part.unit} "
        f"| {_p(finding)} | {finding.seeds or '--'} | {_seeds(finding.needed)} | {finding.reason} |"
        for finding in decision.findings
    ]
    head = (
        "| part | verdict | effect [95% interval] | of | p | n | needed | why |\n"
        + "| --- " * 8
        + "|"
    )
    return [*lines, "\n".join([head, *rows])]


def _markdown_row(decision: Decision) -> str:
    decisive, claim = decision.decisive, decision.claim
    entries = [
        f"[{claim.id}](#{claim.id}-{decision.verdict})",
        claim.place,
        decision.verdict,
        f"{decision.supported}/{len(decision.findings)}",
        decisive.part.label,
        _effect(decisive),
        str(decisive.seeds or "--"),
    ]
    return f"| {' | '.join(entries)} |"


def _effect(finding: PartVerdict) -> str:
    if math.isnan(finding.effect):
        return finding.reason or "--"
    effect, low, high = map(three_figures, (finding.effect, finding.low, finding.high))
    return f"{effect} [{low}, {high}]"


def _p(finding: PartVerdict) -> str:
    return "" if math.isnan(finding.p) else f"{finding.p:.3g}"


def _seeds(needed: float) -> str:
    return f"{needed:.0f}" if needed < 10_000 else "--"


def write_ledger(folder: Path, decisions: Sequence[Decision], campaign: Campaign) -> None:
    """Write claims.tex, claims.csv (each part, full precision), claims.md and claims.json."""
    folder.mkdir(parents=True, exist_ok=True)
    budget = describe_budget(campaign.configuration)
    contents = {
        "tex": f"{as_latex(decisions, budget)}\n",
        "csv": as_table(decisions).to_csv(index=False),
        "md": as_markdown(decisions, budget),
    }
    outputs = [folder / f"claims.{kind}" for kind in contents]
    for path, content in zip(outputs, contents.values(), strict=True):
        write_atomically(path, content.encode())
    sources = campaign.sources(cells(campaign.configuration))
    write_sidecar(outputs, campaign.configuration, sources)
