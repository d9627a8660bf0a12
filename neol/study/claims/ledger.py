"""The ledger: the paper's questions with their answers, as a table, a page and LaTeX."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from neol.base.files import write_atomically
from neol.pictures.labels import three_figures
from neol.study.campaign.grid import cells
from neol.study.claims import verdicts
from neol.study.claims.answers import Answer, Finding
from neol.study.claims.effect import Effect
from neol.study.claims.plan import frozen_plan
from neol.study.claims.questions import Claim, Question
from neol.study.claims.units import in_print, interval_in_print, unit_of
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.movement import NEAR_CONTROL_MARK, NEAR_CONTROL_NOTE
from neol.study.outcomes.statistics import ALPHA
from neol.study.output import markdown
from neol.study.output.captions import describe_budget
from neol.study.output.latex import escape
from neol.study.output.sidecar import write_sidecar

WHOLE = "all"
"""Name of the row of a question as a whole."""
PAPERS_WORDS: dict[str, str] = {
    "reproduced": "shown",
    "same direction": "shown",
    "not reproduced": "not shown",
}
"""Names of verdicts on the paper's own numbers."""


def as_table(answers: Sequence[Answer]) -> pd.DataFrame:
    """Return a row for each part of each question, and one for the whole, at full precision.

    Effects on spread are logarithms of ratios of standard deviations.
    """
    return pd.DataFrame([row for answer in answers for row in _rows(answer)])


def _rows(answer: Answer) -> Iterator[dict[str, Any]]:
    question = answer.question
    about = {
        "question": question.id,
        "family": question.family,
        "verdict": answer.verdict,
        "reason": answer.reason,
        "papers_verdict": answer.papers and PAPERS_WORDS.get(answer.papers, answer.papers),
        "tasks": ",".join(question.tasks),
        "seeds": answer.seeds,
        "level": answer.level,
    }
    whole = {
        "for": answer.counts["for"],
        "against": answer.counts["against"],
        "open": answer.counts["open"],
        "near_control": answer.near_control,
        "p": answer.p,
        "p_holm": answer.p_holm,
        "compatible": answer.compatible,
        "seeds_needed": answer.seeds_needed,
    } | dict(zip(("fresh_effect", "fresh_low", "fresh_high"), _fresh(answer), strict=True))
    numbers = {} if answer.whole is None else _numbers(answer.whole)
    yield about | {"part": WHOLE} | numbers | whole
    for part in answer.parts:
        yield about | {"part": part.evidence.label} | _numbers(part)


def _fresh(answer: Answer) -> tuple[float, float, float]:
    """Return the effect of seeds 10 and up alone, with its 95% interval; NaN without one."""
    if answer.fresh is None:
        return math.nan, math.nan, math.nan
    return answer.fresh.value, *answer.fresh.interval()


def _numbers(finding: Finding) -> dict[str, Any]:
    """Return the state and effect of a part; the paper's interval is a single one at 95%."""
    ours, paper = finding.evidence.ours, finding.evidence.paper
    paper_low, paper_high = paper.interval(1 - ALPHA) if paper else (math.nan, math.nan)
    return {
        "state": finding.state,
        "effect": ours.value if ours else math.nan,
        "low": finding.low,
        "high": finding.high,
        "paper_effect": paper.value if paper else math.nan,
        "paper_low": paper_low,
        "paper_high": paper_high,
        "margin": finding.evidence.margin,
        "near_control": finding.near_control,
    }


def count_words(answers: Sequence[Answer]) -> str:
    """Count the questions by verdict: 3 reproduced, 1 inconclusive."""
    counts = Counter(answer.verdict for answer in answers)
    return ", ".join(f"{count} {verdict}" for verdict, count in counts.most_common())


def as_markdown(answers: Sequence[Answer], claims: Sequence[Claim], budget: str) -> str:
    """Return the ledger as a page: the rules, a summary, each question with parts and quotes."""
    plan = frozen_plan()
    lines = [
        "# The paper's questions",
        budget,
        f"{len(claims)} sentences of the paper raise {len(answers)} questions: "
        f"{count_words(answers)}. {plan}",
        (verdicts.__doc__ or "").strip(),
        markdown.table(
            ["question", "verdict", "parts for / against / open", "effect [interval]",
             "the paper's effect [95%]", "unit", "the paper's own numbers", "seeds (interval)"],
            [_summary(answer) for answer in answers],
        ),
    ]  # fmt: skip
    for answer in answers:
        quotes = [each for each in claims if answer.question.id in each.questions]
        lines += _section(answer, quotes)
    return "\n\n".join(lines) + "\n"


def as_latex(answers: Sequence[Answer], budget: str) -> str:
    """Return the summary as a long table for \\input; it needs booktabs and longtable."""
    head = "Question & Verdict & Parts & Effect [interval] & Paper & Unit & Its own & $n$ \\\\"
    rows = [
        "  " + " & ".join(map(escape, [answer.question.ask, *_summary(answer)[1:]])) + " \\\\"
        for answer in answers
    ]
    caption = (
        "The questions that the paper's claims raise. Parts: for / against / open. Effect: of all "
        "rules together, with the interval of the last complete look, whose coverage stands beside "
        "the number of seeds. Paper: the effect that its tables print, with a 95% interval. Its "
        f"own: the verdict on these numbers by the same rules. {budget}"
    )
    return "\n".join(
        [
            "\\begingroup\\footnotesize\\setlength{\\tabcolsep}{3pt}",
            "\\begin{longtable}{p{0.21\\linewidth}p{0.11\\linewidth}p{0.08\\linewidth}"
            "p{0.15\\linewidth}p{0.15\\linewidth}p{0.07\\linewidth}p{0.08\\linewidth}"
            "p{0.07\\linewidth}}",
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


def _summary(answer: Answer) -> list[str]:
    whole, counts = answer.whole, answer.counts
    question = answer.question
    paper = whole.evidence.paper if whole else None
    return [
        f"[{question.id}](#{_anchor(answer)})",
        answer.verdict,
        f"{counts['for']} / {counts['against']} / {counts['open']}",
        _effect(question, whole.evidence.ours, whole.low, whole.high) if whole else "--",
        _effect(question, paper, *paper.interval(1 - ALPHA)) if paper else "--",
        unit_of(question) or "--",
        "--" if answer.papers is None else PAPERS_WORDS.get(answer.papers, answer.papers),
        seeds_and_level(answer.seeds, answer.level),
    ]


def seeds_and_level(seeds: int, level: float) -> str:
    """Return a number of seeds, with the coverage of the intervals at its look: 20 (98.8%)."""
    return f"{seeds} ({100 * level:.4g}%)" if seeds else "--"


def _section(answer: Answer, quotes: Sequence[Claim]) -> list[str]:
    question = answer.question
    reason = f" ({answer.reason})" if answer.reason else ""
    lines = [f"## {question.id}: {answer.verdict}", f"{question.ask}{reason}"]
    if not math.isnan(answer.p_holm):
        lines.append(
            f"Two-sided p = {answer.p:.3g}, corrected for all looks; {answer.p_holm:.3g} after "
            f"Holm's correction over the family `{question.family}`."
        )
    if not math.isnan(answer.seeds_needed) and answer.verdict == "inconclusive":
        lines.append(f"Detecting the paper's effect takes about {answer.seeds_needed:.0f} seeds.")
    if answer.fresh is not None:
        alone = _effect(question, answer.fresh, *answer.fresh.interval())
        lines.append(f"Seeds 10 and up alone: {alone} (95%).")
    rows = [
        [
            _label(part),
            part.state or "--",
            _effect(question, part.evidence.ours, part.low, part.high),
            three_figures(*in_print(question, _value(part.evidence.paper))),
        ]
        for part in answer.parts
    ]
    unit = unit_of(question) and f" ({unit_of(question)})"
    head = ["part", "is", f"effect{unit} [interval]", "the paper's effect"]
    lines.append(markdown.table(head, rows))
    if any(part.near_control for part in answer.parts):
        lines.append(NEAR_CONTROL_NOTE)
    lines += [f"> {markdown.escape(each.quote)} ({markdown.escape(each.place)})" for each in quotes]
    return lines


def _label(part: Finding) -> str:
    return f"{part.evidence.label}{NEAR_CONTROL_MARK * part.near_control}"


def _anchor(answer: Answer) -> str:
    return f"{answer.question.id}-{answer.verdict.replace(' ', '-')}"


def _effect(question: Question, effect: Effect | None, low: float, high: float) -> str:
    return interval_in_print(question, _value(effect), low, high)


def _value(effect: Effect | None) -> float:
    return math.nan if effect is None else effect.value


def write_ledger(
    folder: Path, answers: Sequence[Answer], claims: Sequence[Claim], *campaigns: Campaign
) -> None:
    """Write claims.tex, claims.csv (each part, full precision), claims.md and claims.json.

    Captions describe the first of the campaigns.
    """
    folder.mkdir(parents=True, exist_ok=True)
    configuration = campaigns[0].configuration
    budget = describe_budget(configuration)
    contents = {
        "tex": f"{as_latex(answers, budget)}\n",
        "csv": as_table(answers).to_csv(index=False),
        "md": as_markdown(answers, claims, budget),
    }
    outputs = [folder / f"claims.{kind}" for kind in contents]
    for path, content in zip(outputs, contents.values(), strict=True):
        write_atomically(path, content.encode())
    sources = [each for one in campaigns for each in one.sources(cells(one.configuration))]
    write_sidecar(outputs, configuration, sources)
