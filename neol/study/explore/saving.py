"""Notebooks without outputs in their files, also while one plays with them."""

from typing import Any

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def without_outputs(model: dict[str, Any], **_: object) -> None:
    """Leave outputs out of a notebook that Jupyter is about to save; the screen keeps them.

    Made for Jupyter's `FileContentsManager.pre_save_hook`. A notebook that was only run is saved
    as it is committed.
    """
    if model["type"] == "notebook":
        for cell in model["content"]["cells"]:
            if cell["cell_type"] == "code":
                cell["outputs"], cell["execution_count"] = [], None
        model["content"]["metadata"] = METADATA
