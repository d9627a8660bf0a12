"""What a budget says in short: the points at the head of the results page, report and README.

Each point has a lead and sentences made of the budget's tables, and says no more than they do.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd

from neol.pictures.labels import listed, task_label, value_range
from neol.study.claims.ledger import WHOLE
from neol.study.claims.questions import load_questions, main_questions
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.movement import NEAR_CONTROL_MARK, NEAR_CONTROL_WORDS
from neol.study.outcomes.statistics import ALPHA
from neol.study.report.reward_scales import at_each_beta
from neol.study.report.speciation import crowded_cells, without_weights
from neol.study.report.words import marked_name

TERMS = (
    "SCORE is the paper's measure of sample efficiency: best fitness summed over generations.",
    "NEAT (w/o) is NEAT without weight mutation, the paper's ablation.",
    "A champion is the best network of a run's last generation; fresh or held-out episodes are "
    "others than those that selected it.",
    f"{NEAR_CONTROL_MARK} marks a rule that is {NEAR_CONTROL_WORDS}.",
)
"""Sentences on the words that the points use; pages print them before."""
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
        f"The paper's claims raise {len(whole)} questions; these runs ask {len(asked)} and "
        f"answer {sum(decided.values())}."
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
        "earlier looks at fewer seeds, nor SCORE's for the choice of the best learning rate."
    )


def is_it_learning(effects: pd.DataFrame) -> str:
    """Say what remains of the rules' advantage beside NEAT without weight mutation."""
    ablation, rules = (_there(effects, of_rules=of_rules) for of_rules in (False, True))
    ablation, others = ablation[_differs(ablation)], rules[rules["against"] == "neat_wo"]
    said = []
    if len(ablation):
        said.append(
            "NEAT without weight mutation (NEAT (w/o)), which does not learn either, differs from "
            f"NEAT too: {_compared(ablation, named=False)}."
        )
    if len(others):
        moving = others[~others["near_control"].eq(True)]
        learned = moving[_differs(moving)]
        if len(moving):
            said.append(
                f"From NEAT (w/o) the rules differ in {len(learned) or 'none'} of {len(moving)} "
                f"comparisons, uncorrected{f': {_compared(learned)}' if len(learned) else ''}."
            )
        if still := len(others) - len(moving):
            said.append(
                f"In {still} {'other comparisons' if len(moving) else 'comparisons'} the rule "
                f"hardly moves a weight ({NEAR_CONTROL_MARK}), so they cannot show learning."
            )
    return " ".join(said) or "No run of NEAT (w/o) is there to tell."


def in_crowded_cells(crowded: str, without_weights: Sequence[str]) -> str:
    """Say in which cells the number of species may explain the outcome, and what a check found."""
    checked = (
        f" Where weights do not count in the distance, {listed(without_weights)}."
        if without_weights
        else ""
    )
    return (
        "Weights that a rule has changed are inherited and count in the distance between genomes, "
        "so high learning rates make many species. In some cells the places that every species "
        f"keeps fill the population in most generations, which nearly stops selection: {crowded}. "
        f"Low values there need not come from learning itself.{checked}"
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
        f"{listed(gaps)}."
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
