"""What each reward scale beta makes of the rules and of the paper's statements: docs/readings.md.

Only eta · beta enters the rules, so a run at (eta, beta) is also that of another pair with the same
product.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

from neol.pictures.labels import listed, method_label, three_figures
from neol.spec.configuration import PAPER_BUDGET, Configuration, load_configuration
from neol.spec.readings import with_changes
from neol.study.campaign.grid import RESULTS, Cell, cells
from neol.study.campaign.reference import settings
from neol.study.claims.questions import RULES
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.contrasts import Difference, Moments, difference
from neol.study.outcomes.paper_numbers import moments

BETAS = (1.0, 0.1, 0.01)
LANDER = "lunar_lander"
HEBB = RULES.index("hebb")
MOST = 0.9
"""Share of runs at the ceiling from which a method is said to reach it."""
NOT_RUN = "not run"

Finals = Callable[[Cell, float], list[float]]
"""Final best fitness of the runs of a cell under a beta; empty without any."""


def reward_scales(reading: str, results: Path = RESULTS) -> list[list[str]]:
    """Return a head, and a row for each beta: what its runs say of each of the three statements.

    The runs are those of a reading at the paper's budget. Raises UserError as `Campaign.runs` does.
    """
    papers, paper = _papers_leads()[HEBB], load_configuration(PAPER_BUDGET, reading=reading)
    rates, ceiling = paper.budget.learning_rates, paper.tasks["cartpole"].max_steps
    head = [
        "beta",
        f"Table 7: on Lunar Lander Hebb at 0.00025 ends {papers.value:.1f} ± {papers.error:.1f} "
        "above NEAT (w/o)",
        "Table 3: BCM's best rate on Lunar Lander is 0.25",
        "A.8.1: on CartPole at 0.25 and P = 50 Oja falls below the ceiling; Hebb and BCM do not",
    ]
    finals = _finals(reading, results)
    rows = [
        [
            _name(beta, paper),
            _hebb_leads(finals, beta),
            _best_rate(finals, beta, rates),
            _oja_falls(finals, beta, ceiling),
        ]
        for beta in BETAS
    ]
    return [head, *rows]


def what_learning_adds(reading: str, results: Path = RESULTS) -> list[list[str]]:
    """Return a head, a row for each beta, and the paper's: the leads over NEAT (w/o).

    Raises UserError as `Campaign.runs` does.
    """
    configuration = load_configuration(PAPER_BUDGET, reading=reading)
    finals, rows = _finals(reading, results), []
    for beta in BETAS:
        leads = _leads_at(finals, beta)
        said = [f"{_in_words(each.found)}, {each.runs} runs" if each else NOT_RUN for each in leads]
        rows.append([_name(beta, configuration), *said])
    papers = [_in_words(each) for each in _papers_leads()]
    return [["beta", *map(method_label, RULES)], *rows, ["the paper", *papers]]


class _Lead(NamedTuple):
    """A rule's final best fitness minus that of NEAT (w/o), on Lunar Lander."""

    found: Difference
    runs: int
    """Runs of the rule."""
    against: int
    """Runs of NEAT (w/o)."""


def _leads_at(finals: Finals, beta: float) -> list[_Lead | None]:
    """Return the lead of each of `RULES` in Table 4's configuration; None where it has no runs."""
    ours = [finals(_configured(rule), beta) for rule in RULES]
    without = finals(_configured("neat_wo"), beta)
    return [
        _Lead(difference(Moments.of(each), Moments.of(without)), len(each), len(without))
        if each and without
        else None
        for each in ours
    ]


def at_each_beta(configuration: Configuration, results: Path = RESULTS) -> str:
    """Say what learning adds at each beta that has its runs.

    Empty for a budget without the paper's runs of Lunar Lander, and where fewer than two betas have
    their runs.
    """
    budget, papers = configuration.budget, load_configuration(PAPER_BUDGET).budget
    if LANDER not in budget.tasks or budget.generations_of(LANDER) < papers.generations_of(LANDER):
        return ""
    finals, found = _finals(configuration.reading, results), {}
    for beta in BETAS:
        leads = [lead for lead in _leads_at(finals, beta) if lead]
        if len(leads) == len(RULES):
            found[beta] = [lead.found for lead in leads]
    if len(found) < 2:
        return ""
    by_rule = zip(RULES, zip(*found.values(), strict=True), _papers_leads(), strict=True)
    said = [
        f"{method_label(rule)} {listed(map(_value, leads))} (the paper: {_value(papers)})"
        for rule, leads, papers in by_rule
    ]
    above = _where(found, lambda lead: lead.interval()[0] > 0)
    below = _where(found, lambda lead: lead.interval()[1] < 0)
    return (
        "The paper does not give beta, the scale of the reward; a smaller one acts like lower "
        "learning rates. Final fitness on Lunar Lander minus that of NEAT (w/o) is, at beta = "
        f"{listed(f'{beta:g}' for beta in found)}: {'; '.join(said)}. Distinguishably above NEAT "
        f"(w/o): {above}. Below: {below}."
    )


def _where(found: Mapping[float, Sequence[Difference]], holds: Callable[[Difference], bool]) -> str:
    """Name the rules, each with the betas at which something holds of its lead."""
    said = []
    for place, rule in enumerate(RULES):
        betas = [f"{beta:g}" for beta, leads in found.items() if holds(leads[place])]
        if betas:
            said.append(f"{method_label(rule)} at {listed(betas)}")
    return "; ".join(said) or "none"


def _value(lead: Difference) -> str:
    return three_figures(lead.value)


def _papers_leads() -> list[Difference]:
    """Return the lead of each of `RULES` in the paper's Table 7."""
    printed = moments([7], LANDER)
    return [difference(printed[rule], printed["neat_wo"]) for rule in RULES]


def _configured(method: str) -> Cell:
    """Return a method's cell on Lunar Lander in Table 4."""
    return Cell(LANDER, method, *settings(4)[LANDER, method])


def _name(beta: float, configuration: Configuration) -> str:
    return f"{beta:g}{' (default)' * (beta == configuration.plasticity.reward_scale)}"


def _in_words(lead: Difference) -> str:
    low, high = lead.interval()
    return f"{lead.value:+.1f} [{low:.1f}, {high:.1f}]"


def _finals(reading: str, results: Path) -> Finals:
    """Return the function that finds runs of a cell under a beta, or with the same eta · beta."""
    changed = [with_changes(reading, f"plasticity.reward_scale={beta:g}") for beta in BETAS]
    found = [
        Campaign(load_configuration(PAPER_BUDGET, reading=each), results, partial=True)
        for each in (reading, *changed)
    ]

    @cache
    def finals(wanted: Cell, beta: float) -> list[float]:
        for campaign in found:
            scale = campaign.configuration.plasticity.reward_scale
            for cell in cells(campaign.configuration):
                products = ((cell.learning_rate or 0) * scale, (wanted.learning_rate or 0) * beta)
                same = replace(cell, learning_rate=wanted.learning_rate) == wanted
                if not (same and math.isclose(*products, rel_tol=1e-9)):
                    continue
                if runs := list(campaign.runs(cell).final_best.values()):
                    return runs
        return []

    return finals


def _hebb_leads(finals: Finals, beta: float) -> str:
    """Compare Hebb's lead over NEAT (w/o) on Lunar Lander with that of Table 7."""
    lead = _leads_at(finals, beta)[HEBB]
    if lead is None:
        return NOT_RUN
    low, high = lead.found.interval()
    paper_low, _ = _papers_leads()[HEBB].interval()
    verdict = "seen" if low > 0 else "contradicted" if high < paper_low else "open"
    return f"{verdict}: {_in_words(lead.found)}, {lead.runs} against {lead.against} runs"


def _best_rate(finals: Finals, beta: float, rates: Sequence[float]) -> str:
    """Compare BCM's learning rates on Lunar Lander."""
    runs = {rate: finals(Cell(LANDER, "bcm", 300, rate), beta) for rate in rates}
    known = {rate: Moments.of(each) for rate, each in runs.items() if each}
    if 0.25 not in known or len(known) == 1:
        return NOT_RUN
    best = max(known, key=lambda rate: known[rate].mean)
    said = "; ".join(f"{rate:g}: {known[rate].mean:.0f} ± {known[rate].sd:.0f}" for rate in known)
    lead = difference(known[best], known[0.25])
    if best == 0.25:
        verdict = "seen" if len(known) == len(rates) else "open"
    else:
        verdict = "contradicted" if lead.interval()[0] > 0 else "open"
    return f"{verdict}: {said}"


def _oja_falls(finals: Finals, beta: float, ceiling: float) -> str:
    """Count the runs that end at CartPole's ceiling."""
    runs = {rule: finals(Cell("cartpole", rule, 50, 0.25), beta) for rule in ("oja", "hebb", "bcm")}
    if not all(runs.values()):
        return NOT_RUN
    there = {rule: sum(final == ceiling for final in each) for rule, each in runs.items()}
    shares = {rule: there[rule] / len(each) for rule, each in runs.items()}
    seen = shares["oja"] < MOST <= min(shares["hebb"], shares["bcm"])
    said = ", ".join(f"{method_label(rule)} {there[rule]} of {len(runs[rule])}" for rule in runs)
    return f"{'seen' if seen else 'contradicted'}: at the ceiling end {said}"
