"""Executed notebook of the site: cells of a plain script, run by Jupyter, with what they show.

The script stands in `examples/`. A line `# %%` begins a cell of code, and `# %% [markdown]` a cell
of text in comments. Editors open it as a notebook, and Python runs it as a script.
"""

from __future__ import annotations

import base64
import json
import os
import re
import tempfile
from pathlib import Path
from typing import Any

SCRIPT = Path(__file__).resolve().parents[2] / "examples" / "tour_in_jupyter.py"
TIME_LIMIT_S = 300
"""Time limit of a cell [s]."""
_CELL = re.compile(r"^# %%(?P<kind>.*)$", re.MULTILINE)


def read_cells(script: str) -> list[tuple[str, str]]:
    """Split a script into cells: kind ("markdown" or "code") and source.

    What stands before the first is left out.
    """
    _, *parts = _CELL.split(script)
    cells = []

    for mark, body in zip(parts[::2], parts[1::2], strict=True):
        text = body.strip("\n")
        if "[markdown]" in mark:
            cells.append(("markdown", re.sub(r"^# ?", "", text, flags=re.MULTILINE)))
        else:
            cells.append(("code", text))

    return cells


def to_ipynb(script: Path = SCRIPT) -> str:
    """Write the script as a notebook without outputs."""
    cells = []
    for i, (kind, source) in enumerate(read_cells(script.read_text(encoding="utf-8"))):
        cell: dict[str, Any] = {
            "cell_type": kind,
            "id": f"cell-{i}",
            "metadata": {},
            "source": source,
        }
        cells.append(cell | ({"execution_count": None, "outputs": []} if kind == "code" else {}))

    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    return (
        json.dumps(
            {
                "cells": cells,
                "metadata": kernel,
                "nbformat": 4,
                "nbformat_minor": 5,
            },
            indent=1,
        )
        + "\n"
    )


def execute(script: Path = SCRIPT) -> str:
    """Run the notebook in a folder of its own, and write it with its outputs as Markdown.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails.
    """
    import nbformat
    from nbclient import NotebookClient

    book = nbformat.reads(to_ipynb(script), as_version=4)

    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(
            book, timeout=TIME_LIMIT_S, resources={"metadata": {"path": folder}}
        )
        client.execute(env=os.environ | {"PYTHONPATH": os.pathsep.join(_python_path())})

    return "\n\n".join(_render(cell) for cell in book.cells) + "\n"


def _python_path() -> list[str]:
    """Folders that the kernel imports from, as this process does."""
    return [
        str(Path(entry).resolve())
        for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep)
        if entry
    ]


def _render(cell: Any) -> str:
    """Write a cell with its outputs as Markdown."""
    if cell.cell_type == "markdown":
        return str(cell.source)

    return "\n\n".join(
        [f"```python\n{cell.source}\n```", *(_render_output(output) for output in cell.outputs)]
    )


def _render_output(output: Any) -> str:
    """Write an output as Markdown: a picture, a table or text."""
    data = output.get("data", {"text/plain": output.get("text", "")})
    if "image/png" in data:
        encoded = base64.b64encode(base64.b64decode(data["image/png"])).decode()
        return f'<img alt="Output of the cell above" src="data:image/png;base64,{encoded}">'

    if "text/html" in data:
        return str(data["text/html"])

    return f"```text\n{str(data.get('text/plain', '')).rstrip()}\n```"
