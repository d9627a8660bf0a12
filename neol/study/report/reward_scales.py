"""What each reward scale beta makes of the rules and of the paper's statements: docs/readings.md.

Only eta · beta enters the rules, so a run at (eta, beta) is also that of another pair with the same
product.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

from neol.pictures.labels import method_label
from neol.spec.configuration import PAPER_BUDGET, Configuration, load_configuration
from neol.spec.readings import with_changes
from neol.study.campaign.grid import RESULTS, Cell, cells
from neol.study.claims.questions import RULES
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.contrasts import Difference, Moments, difference
from neol.study.outcomes.paper_numbers import moments, settings

BETAS = (1.0, 0.1, 0.01)
LANDER = "lunar_lander"
MOST = 0.9
"""Share of runs at the ceiling from which a method is said to reach it."""
NOT_RUN = "not run"

Finals = Callable[[Cell], list[float]]
"""Final best fitness of the runs of a cell; empty without any."""


def reward_scales(reading: str, results: Path = RESULTS) -> list[list[str]]:
    """Return a head, and a row for each beta: what its runs say of each of the three statements.

    The runs are those of a reading at the paper's budget. Raises UserError as `Campaign.runs` does.
    """
    papers, paper = _papers_lead(), load_configuration(PAPER_BUDGET, reading=reading)
    rates, ceiling = paper.budget.learning_rates, paper.tasks["cartpole"].max_steps
    head = [
        "beta",
        f"Table 7: on Lunar Lander Hebb at 0.00025 ends {papers.value:.1f} ± {papers.error:.1f} "
        "above NEAT (w/o)",
        "Table 3: BCM's best rate on Lunar Lander is 0.25",
        "A.8.1: on CartPole at 0.25 and P = 50 Oja falls below the ceiling; Hebb and BCM do not",
    ]
    rows = []
    for beta in BETAS:
        finals = _finals(reading, beta, results)
        statements = _hebb_leads(finals), _best_rate(finals, rates), _oja_falls(finals, ceiling)
        rows.append([_name(beta, paper), *statements])
    return [head, *rows]


def what_learning_adds(reading: str, results: Path = RESULTS) -> list[list[str]]:
    """Return a head, a row for each beta, and the paper's: each rule minus NEAT (w/o).

    Compared is the final best fitness on Lunar Lander in Table 4's configurations. The runs, and
    the errors raised, are those of `reward_scales`.
    """
    configuration = load_configuration(PAPER_BUDGET, reading=reading)
    printed = moments([7], LANDER)
    rows = []
    for beta in BETAS:
        finals = _finals(reading, beta, results)
        without = finals(_configured("neat_wo"))
        leads = [_lead(finals(_configured(rule)), without) for rule in RULES]
        rows.append([_name(beta, configuration), *leads])
    papers = [_in_words(difference(printed[rule], printed["neat_wo"])) for rule in RULES]
    return [["beta", *map(method_label, RULES)], *rows, ["the paper", *papers]]


def _name(beta: float, configuration: Configuration) -> str:
    return f"{beta:g}{' (default)' * (beta == configuration.plasticity.reward_scale)}"


def _configured(method: str) -> Cell:
    """Return a method's cell on Lunar Lander in Table 4."""
    return Cell(LANDER, method, *settings(4)[LANDER, method])


def _lead(ours: Sequence[float], without: Sequence[float]) -> str:
    if not (ours and without):
        return NOT_RUN
    lead = difference(Moments.of(ours), Moments.of(without))
    return f"{_in_words(lead)}, {len(ours)} runs"


def _in_words(lead: Difference) -> str:
    low, high = lead.interval()
    return f"{lead.value:+.1f} [{low:.1f}, {high:.1f}]"


def _finals(reading: str, beta: float, results: Path) -> Finals:
    """Return the function that finds runs under a beta, or with the same eta · beta."""
    others = [with_changes(reading, f"plasticity.reward_scale={each:g}") for each in BETAS]
    found = [
        Campaign(load_configuration(PAPER_BUDGET, reading=each), results, partial=True)
        for each in dict.fromkeys((reading, *others))
    ]

    @cache
    def finals(wanted: Cell) -> list[float]:
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


def _papers_lead() -> Difference:
    """Return Hebb's lead over NEAT (w/o) on Lunar Lander in Table 7."""
    paper = moments([7], LANDER)
    return difference(paper["hebb"], paper["neat_wo"])


def _hebb_leads(finals: Finals) -> str:
    """Compare Hebb's lead over NEAT (w/o) on Lunar Lander with that of Table 7."""
    hebb = finals(Cell(LANDER, "hebb", 300, 0.00025))
    without = finals(Cell(LANDER, "neat_wo", 300, None))
    if not (hebb and without):
        return NOT_RUN
    ours = difference(Moments.of(hebb), Moments.of(without))
    low, high = ours.interval()
    paper_low, _ = _papers_lead().interval()
    verdict = "seen" if low > 0 else "contradicted" if high < paper_low else "open"
    return f"{verdict}: {_in_words(ours)}, {len(hebb)} against {len(without)} runs"


def _best_rate(finals: Finals, rates: Sequence[float]) -> str:
    """Compare BCM's learning rates on Lunar Lander."""
    runs = {rate: finals(Cell(LANDER, "bcm", 300, rate)) for rate in rates}
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


def _oja_falls(finals: Finals, ceiling: float) -> str:
    """Count the runs that end at CartPole's ceiling."""
    runs = {rule: finals(Cell("cartpole", rule, 50, 0.25)) for rule in ("oja", "hebb", "bcm")}
    if not all(runs.values()):
        return NOT_RUN
    there = {rule: sum(final == ceiling for final in each) for rule, each in runs.items()}
    shares = {rule: there[rule] / len(each) for rule, each in runs.items()}
    seen = shares["oja"] < MOST <= min(shares["hebb"], shares["bcm"])
    said = ", ".join(f"{method_label(rule)} {there[rule]} of {len(runs[rule])}" for rule in runs)
    return f"{'seen' if seen else 'contradicted'}: at the ceiling end {said}"
