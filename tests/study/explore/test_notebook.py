"""notebooks/explore.ipynb in a kernel: it draws by itself, and again after a change of controls."""

import base64
import json
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from neol.spec.configuration import ROOT

pytestmark = pytest.mark.slow

PLAY = """
def titles(panel):
    return [axis.get_title() for axis in panel.picture.axes]

run.record.value = "rare_mutation/demo/cartpole/neat/p050/seeds_000-004.parquet"
assert network.picture.get_suptitle().startswith("CartPole, NEAT, seed 0"), network.picture
assert "does not learn" in learned.picture.data
assert played.picture.trace.episode_return == load_player(*run.value).recorded_returns[0]
run.seed.value = 2
assert "seed 2" in network.picture.get_suptitle()

run.record.value = "rare_mutation/demo/cartpole/oja/p050_lr0.25/seeds_000-004.parquet"
before = played.picture
played.controls["plastic"].value = False
assert (played.picture.trace.weights == played.picture.trace.weights[0]).all()
assert not (before.trace.weights == before.trace.weights[0]).all()

episodes.value = 5
step.value = 10
assert stopped.picture.axes[2].get_ylabel() == "Return, plastic to step 10"

task.value = "cartpole"
curves.controls["column"].value = "species"
assert curves.picture.axes[0].get_ylabel() == "Species"
assert answer.picture.axes[0].get_title() == "CartPole, budget rare_mutation/demo"
answer.controls["budget"].value = "rare_mutation/paper"
assert answer.picture.axes[0].get_title() == "CartPole, budget rare_mutation/paper"

changed = {"task": "cartpole", "method": "bcm", "population": 10, "generations": 5}
for name, value in changed.items():
    evolution.controls[name].value = value
assert "Lunar Lander" in titles(evolution)[0]
evolution.button.click()
assert "CartPole, champion in 20 fresh episodes" in titles(evolution)[0]
"""


@pytest.fixture(scope="module")
def executed() -> Any:
    """The notebook, run to its end with a cell more that plays with the controls."""
    notebook = nbformat.read(ROOT / "notebooks" / "explore.ipynb", as_version=4)
    notebook.cells.append(nbformat.v4.new_code_cell(PLAY))
    client = NotebookClient(notebook, resources={"metadata": {"path": ROOT / "notebooks"}})
    client.execute()
    return notebook


def test_every_panel_has_a_picture_of_its_own(executed: Any) -> None:
    """Beside its controls, so that a copy reads well where no kernel is."""
    pictures = 0
    for cell in executed.cells[:-1]:
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "image/png" in data:
                assert base64.b64decode(data["image/png"]).startswith(b"\x89PNG")
                pictures += 1
            pictures += "data:image/gif;base64," in data.get("text/html", "")
    assert pictures == 7
    assert "drawing ..." not in json.dumps(executed)
