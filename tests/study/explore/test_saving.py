"""Saving: what was only run is saved as it is committed."""

import asyncio
from pathlib import Path

import pytest
from jupyter_server.services.contents.filemanager import AsyncFileContentsManager

from neol.spec.configuration import ROOT


@pytest.mark.parametrize("name", ["explore", "tables"])
def test_a_notebook_that_was_run_is_saved_as_it_is_committed(name: str, tmp_path: Path) -> None:
    """Through Jupyter's own manager, as the Makefile configures it."""
    committed = (ROOT / "notebooks" / f"{name}.ipynb").read_bytes()
    hook = "neol.study.explore.saving.without_outputs"
    assert hook in (ROOT / "Makefile").read_text()
    (tmp_path / "a.ipynb").write_bytes(committed)
    manager = AsyncFileContentsManager(root_dir=str(tmp_path), pre_save_hook=hook)
    model = asyncio.run(manager.get("a.ipynb"))
    for number, cell in enumerate(model["content"]["cells"]):
        if cell["cell_type"] == "code":
            cell["execution_count"] = number
            cell["outputs"] = [{"output_type": "stream", "name": "stdout", "text": "hello"}]
    model["content"]["metadata"]["kernelspec"]["display_name"] = "Python 3 (ipykernel)"
    model["content"]["metadata"]["widgets"] = {"state": {}}
    asyncio.run(manager.save(model, "a.ipynb"))
    assert (tmp_path / "a.ipynb").read_bytes() == committed
