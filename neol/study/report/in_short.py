"""What a budget says in short: the points at the head of the results page, report and README.

Each point has a lead and sentences made of the budget's tables, and says no more than they do.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd

from neol.pictures.labels import listed, method_label, task_label, value_range
from neol.study.claims.ledger import WHOLE
from neol.study.claims.questions import load_questions, main_questions
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.movement import NEAR_CONTROL_MARK, NEAR_CONTROL_WORDS
from neol.study.outcomes.statistics import ALPHA
from neol.study.report.reward_scales import at_each_beta
from neol.study.report.speciation import crowded_cells, without_weights
from neol.study.report.words import marked_name

TERMS = (
    "SCORE is the paper's measure of sample efficiency: best fitness summed over generations, "
    "times the population, divided by a constant.",
    "NEAT (w/o) is NEAT without weight mutation, the paper's ablation.",
    "A champion is the best network of a run's last generation; fresh or held-out episodes are "
    "others than those that selected it.",
)
"""Sentences on the words that the points use; pages print them before."""
MARK = f"{NEAR_CONTROL_MARK} marks a rule that is {NEAR_CONTROL_WORDS}."
ANSWERS = {
    "reproduced": "Yes",
    "same direction": "Yes, but by another amount",
    "mixed": "Not all of them",
    "not reproduced": "No",
    "equivalent to zero": "No, any difference is below the margin that the plan set",
}
"""Verdicts that are answers, from the paper's side to the other, and what each answers."""


class Point(NamedTuple):
    """A point of the summary."""

    lead: str
    text: str

    def markdown(self) -> str:
        """Return the point with its lead in bold."""
        return f"**{self.lead}** {self.text}"


def terms(*tables: pd.DataFrame) -> str:
    """Explain the words that the points use, and the mark if a rule in the tables has it."""
    is_marked = any(table["near_control"].eq(True).any() for table in tables)
    return " ".join((*TERMS, MARK) if is_marked else TERMS)


def in_short(
    campaign: Campaign,
    species: pd.DataFrame,
    ledger: pd.DataFrame,
    effects: pd.DataFrame,
    selection: pd.DataFrame,
) -> list[Point]:
    """Return the points, from the tables of species, verdicts, effects and selection bias."""
    points = [
        Point("The paper's questions.", questions_answered(ledger)),
        Point("The rules against NEAT.", against_neat(effects)),
        Point("Is that learning?", is_it_learning(effects)),
    ]
    if scaled := at_each_beta(campaign.configuration):
        points.append(Point("Or the scale of the reward?", scaled))
    if crowded := crowded_cells(species):
        found = in_crowded_cells(crowded, without_weights(campaign, species))
        points.append(Point("Or is it speciation?", found))
    points.append(Point("In fresh episodes.", in_fresh_episodes(selection)))
    return points


def questions_answered(ledger: pd.DataFrame) -> str:
    """Count the questions of the paper by verdict, and name those that are answered.

    The main claims are counted but not named: they have a table of their own.
    """
    whole = ledger[ledger["part"] == WHOLE]
    asked = whole[whole["verdict"] != "not asked here"]
    counts = asked["verdict"].value_counts(sort=False)
    decided = {verdict: counts[verdict] for verdict in ANSWERS if verdict in counts}
    rest = {verdict: count for verdict, count in counts.items() if verdict not in decided}
    said = [
        f"The paper's claims raise {len(whole)} questions, those of the main claims among them; "
        f"these runs ask {len(asked)} and answer {sum(decided.values())}."
    ]
    main = [question.id for question in main_questions()]
    others = asked[~asked["question"].isin(main)]
    named = [(verdict, found) for verdict in decided if (found := _of_questions(others, verdict))]
    if named:
        said.append("The answers beside the main claims follow.")
    said += [f"{str(verdict).capitalize()}: {found}" for verdict, found in named]
    if rest:
        said.append(f"Not answered: {listed(f'{count} {name}' for name, count in rest.items())}.")
    return " ".join(said)


def against_neat(effects: pd.DataFrame) -> str:
    """Say which tests of single rules against NEAT hold after correction for their number."""
    rules = _there(effects, of_rules=True)
    tests = rules[rules["against"] == "neat"].dropna(subset="p_holm")
    held = tests[tests["p_holm"] < ALPHA]
    if tests.empty:
        return "No test could be made."
    verb = "holds" if len(held) == 1 else "hold"
    return (
        f"Of {len(tests)} tests of single rules, {len(held) or 'none'} {verb} after Holm's "
        f"correction{f': {_compared(held)}' if len(held) else ''}. They are not corrected for "
        "earlier looks at fewer seeds. For SCORE the same seeds choose a rule's learning rate and "
        "test it, which favours the rule; the paper's questions use separate seeds."
    )


def is_it_learning(effects: pd.DataFrame) -> str:
    """Say what remains of the rules' advantage beside NEAT without weight mutation."""
    ablation, rules = (_there(effects, of_rules=of_rules) for of_rules in (False, True))
    ablation, others = ablation[_differs(ablation)], rules[rules["against"] == "neat_wo"]
    if others.empty:
        return "No run of NEAT (w/o) is there to tell."
    moving = others[~others["near_control"].eq(True)]
    above, below = moving[moving["low"] > 0], moving[moving["high"] < 0]
    said = [
        f"{'In part' if len(above) else 'Not shown'}. NEAT without weight mutation (NEAT (w/o)) "
        "cannot learn within an episode."
    ]
    if len(moving):
        said.append(
            f"Of {len(moving)} comparisons with it, uncorrected, a rule is distinguishably above "
            f"in {_counted(above)} and below in {_counted(below)}."
        )
    if still := len(others) - len(moving):
        said.append(
            f"In {still} {'other comparisons' if len(moving) else 'comparisons'} the rule "
            f"hardly moves a weight ({NEAR_CONTROL_MARK}), so they cannot show learning."
        )
    if len(ablation):
        said.append(f"NEAT (w/o) itself differs from NEAT: {_compared(ablation, named=False)}.")
    return " ".join(said)


def in_crowded_cells(crowded: str, without_weights: Sequence[str]) -> str:
    """Say in which cells the number of species may explain the outcome, and what a check found."""
    checked = (
        f" If weights do not count in the distance, {listed(without_weights)}."
        if without_weights
        else ""
    )
    return (
        "Weights that a rule has changed are inherited and count in the distance between genomes, "
        "so high learning rates make many species, each of which keeps a few places in the next "
        "generation. Where these places fill the population in most generations, selection nearly "
        f"stops: {crowded}. Low values there need not come from learning itself.{checked}"
    )


def in_fresh_episodes(selection: pd.DataFrame) -> str:
    """Say how much less champions return in fresh episodes than in training, for each task."""
    known = selection.dropna(subset="mean")
    gaps = [
        f"{value_range(rows['mean'])} less on {task_label(str(task))}"
        for task, rows in known.groupby("task", sort=False)
    ]
    if not gaps:
        return "No champion was played in fresh episodes."
    return (
        "Final best fitness is a maximum over noisy episodes. In fresh episodes, champions return "
        f"{listed(gaps)}. Each range is over the methods and population sizes, with the mean over "
        "learning rates and seeds."
    )


def _there(effects: pd.DataFrame, *, of_rules: bool) -> pd.DataFrame:
    """Return the comparisons of single tasks that have runs: of the rules, or of NEAT (w/o)."""
    there = (effects["task"] != "all") & (effects["seeds"] > 0)
    return effects[there & ((effects["method"] != "neat_wo") == of_rules)]


def _differs(rows: pd.DataFrame) -> "pd.Series[bool]":
    return (rows["low"] > 0) | (rows["high"] < 0)


def _compared(rows: pd.DataFrame, *, named: bool = True) -> str:
    """Return outcome and task of comparisons, with their methods: SCORE on Hopper (BCM higher)."""
    said = []
    for (outcome, task), some in rows.groupby(["outcome", "task"], sort=False):
        entries = [_entry(row, named=named) for row in some.to_dict("records")]
        said.append(f"{outcome} on {task_label(str(task))} ({', '.join(entries)})")
    return "; ".join(said)


def _counted(rows: pd.DataFrame) -> str:
    """Count comparisons, and name them by outcome and task: 2: SCORE (Hopper: BCM, Oja)."""
    said = [
        f"{outcome} ({'; '.join(_methods_by_task(some))})"
        for outcome, some in rows.groupby("outcome", sort=False)
    ]
    return f"{len(rows)}: {listed(said)}" if said else "none"


def _methods_by_task(rows: pd.DataFrame) -> list[str]:
    return [
        f"{task_label(str(task))}: {', '.join(map(method_label, some['method']))}"
        for task, some in rows.groupby("task", sort=False)
    ]


def _entry(row: Mapping[Any, Any], *, named: bool) -> str:
    side = "higher" if row["difference"] > 0 else "lower"
    return f"{marked_name(row)} {side}" if named else side


def _of_questions(whole: pd.DataFrame, verdict: str) -> str:
    """Ask and answer the questions with a verdict.

    The mark says that no rule moves in any part of one.
    """
    asked = {question.id: question.ask for question in load_questions()}
    rows = whole[whole["verdict"] == verdict].to_dict("records")
    return " ".join(
        f"{asked[row['question']]} {ANSWERS[verdict]}{NEAR_CONTROL_MARK * row['near_control']}."
        for row in rows
    )
