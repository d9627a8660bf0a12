"""Saving of notebooks without outputs, also during interactive use."""

from typing import Any

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def without_outputs(model: dict[str, Any], **_: object) -> None:
    """Remove outputs from a notebook that Jupyter is about to save; the screen keeps them.

    For Jupyter's `FileContentsManager.pre_save_hook`. A notebook that was only run is saved as it
    was committed.
    """
    if model["type"] == "notebook":
        for cell in model["content"]["cells"]:
            if cell["cell_type"] == "code":
                cell["outputs"], cell["execution_count"] = [], None
        model["content"]["metadata"] = METADATA
