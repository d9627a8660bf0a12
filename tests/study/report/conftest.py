"""A made-up campaign on all four tasks, and the workflow's files of it."""

from pathlib import Path

import pytest
from PIL import Image

from neol.pictures.labels import TASK_LABELS
from neol.study.claims.answers import answers
from neol.study.claims.ledger import write_ledger
from neol.study.claims.questions import load_claims, load_questions
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.effects import effect_sizes, selection_bias
from neol.study.outcomes.outcomes import gather
from neol.study.outcomes.sensitivity import sensitivity
from neol.study.output.sidecar import write_sidecar
from neol.study.tables import agreement, paper_tables
from tests.helpers.made_up import configuration, write_campaign


@pytest.fixture(scope="session")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    """Return a campaign on all four tasks; every run ends at 7."""
    results = tmp_path_factory.mktemp("results")
    budget = configuration(tasks=tuple(TASK_LABELS), seeds=5)
    write_campaign(results, budget, {}, otherwise=7.0)
    return Campaign(budget, results)


@pytest.fixture(scope="session")
def figures(campaign: Campaign, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the files that the page and the paper read of these runs: ledger and grey pictures."""
    folder = tmp_path_factory.mktemp("figures")
    for number in range(1, 9):
        getattr(paper_tables, f"table{number}")(campaign).write(folder)
    for number in (1, 2, 7, 8):
        getattr(agreement, f"numbers{number}")(campaign).write(folder)
    outcomes = gather(campaign)
    write_ledger(folder, answers(load_questions(), outcomes), load_claims(), campaign)
    for name, table in {
        "beyond_effects": effect_sizes(outcomes, campaign.configuration.budget),
        "beyond_selection": selection_bias(outcomes),
        "beyond_sensitivity": sensitivity(campaign.configuration, folder)[0],
    }.items():
        outputs = [folder / f"{name}.csv", folder / f"{name}.png"]
        table.to_csv(outputs[0], index=False)
        Image.new("L", (900, 300), 128).save(outputs[1])
        write_sidecar(outputs, campaign.configuration, ())
    Image.new("L", (900, 300), 128).save(folder / "figure2.png")
    write_sidecar([folder / "figure2.png"], campaign.configuration, ())
    return folder
