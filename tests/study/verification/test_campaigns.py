"""What the budgets of config/ have in their folders."""

from neol.spec.configuration import ROOT
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.jobs import SENSITIVITY
from neol.study.verification.check import Verification
from neol.study.verification.manifest import records_of


def test_a_folder_is_not_asked_for_records_that_another_budget_keeps() -> None:
    own = records_of(f"{DEFAULT_READING}/evidence").values()
    of_cells = {job.spec.task.name for job in own if job.part != SENSITIVITY}
    assert of_cells == {"hopper"}


def test_of_many_campaigns_the_complete_ones_are_counted() -> None:
    searched = sorted((ROOT / "results").glob("*moderate_mutation/search"))
    confirmed = sorted((ROOT / "results").glob("*_mutation/confirmation"))
    verification = Verification([*searched, *confirmed])
    assert not [finding for checked in verification.check() for finding in checked.findings]
    assert "0 of 5 campaigns complete" in list(verification.notes())
