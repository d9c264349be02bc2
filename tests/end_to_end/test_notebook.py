"""The tutorial notebook: executed from top to bottom in a fresh kernel, with pandas and with polars alone."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import nbclient
import nbformat
import pytest

from shared import ROOT

NOTEBOOK = ROOT / "docs" / "tutorial" / "in_a_notebook.ipynb"
ALONE = """
import importlib.machinery
finder, find = importlib.machinery.PathFinder, importlib.machinery.PathFinder.find_spec
finder.find_spec = lambda name, *more: None if name.partition(".")[0] in {blocked!r} else find(name, *more)
"""
LARGEST = 100_000


BAR = """
import time
from truing import progress
progress.PATIENCE = 0.1
with progress.progress_bar(True) as report:
    for step in (2, 4):
        report("reliability", step, 8)
        time.sleep(0.25 * step)
"""


def executed(folder: Path, *blocked: str) -> tuple[Any, list[str]]:
    """Run the notebook, and where it has pandas some long work last, in a kernel that does not find some packages.

    Return it with what its displays drew, one after the other.
    """
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell(ALONE.format(blocked=blocked)))
    if "pandas" not in blocked:  # a bar is one whatever the frames
        notebook.cells.append(nbformat.v4.new_code_cell(BAR))
    client = nbclient.NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}}
    )
    drawn: list[str] = []
    process = client.process_message

    def listening(message: Any, cell: Any, number: int) -> Any:
        if message["msg_type"] in ("display_data", "update_display_data"):
            drawn.append(message["content"]["data"].get("text/html", ""))
        return process(message, cell, number)

    client.process_message = listening  # type: ignore[method-assign]
    client.execute()
    return notebook, drawn


def outputs(notebook: Any) -> list[Any]:
    """Return what the cells show and print, one after the other."""
    return [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]


def texts(notebook: Any, form: str = "text/plain") -> list[str]:
    """Return what the cells show in one form, and what they print."""
    return [output.get("data", {}).get(form) or output.get("text", "") for output in outputs(notebook)]


@pytest.mark.parametrize("blocked", [("polars", "pyarrow"), ("pandas", "pyarrow")], ids=["pandas", "polars"])
def test_the_notebook_runs_in_a_fresh_kernel(tmp_path: Path, blocked: tuple[str, ...]) -> None:
    """What the words between the cells say of its numbers is true.

    Long work shows a bar, drawn anew, and takes it away; nothing else is printed.
    """
    notebook, drawn = executed(tmp_path, *blocked)
    said = "\n".join(texts(notebook))
    assert not [
        output for cell in notebook.cells for output in cell.get("outputs", ()) if output.get("name") == "stderr"
    ]
    assert "<Run of spring: passes, 2 limits, 3 results>" in said
    assert "softening" in said
    assert "Did you mean 'compression'" in said
    assert {file.name for file in tmp_path.iterdir()} >= {"warm_spring.html", "diagnosis.html", "runs", "spring.py"}
    html = [text for text in texts(notebook, "text/html") if "<" in text]
    assert len([text for text in html if "data:image/png;base64," in text]) == 1
    assert max(map(len, html)) < LARGEST
    assert (
        sum("image/png" in output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", ())) == 1
    )
    words = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    shown = "\n".join(html)
    for number in ("609.5", "700 MPa", "13 %"):
        assert number in words
    assert "609.51 MPa" in shown
    assert "12.9 %" in shown
    low, high = map(float, re.findall(r"95 %: (\S+) to (\S+)", "\n".join(texts(notebook)))[0])
    assert low < 2.5e-4 < high
    if "pandas" not in blocked:
        assert any("reliability" in html and "50 %" in html for html in drawn)
        assert drawn[-1] == ""
        assert [shown["data"] for shown in notebook.cells[-1].outputs] == [{"text/plain": ""}]


def test_the_notebook_is_kept_without_output() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    assert not [cell.id for cell in notebook.cells if cell.get("outputs") or cell.get("execution_count")]
