"""The notebook of the documents runs, and finds what it hides."""

import json
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from tests.documents.pages import ROOT

NOTEBOOK = ROOT / "docs/bent-shaft.ipynb"


def test_it_is_kept_without_what_a_run_left_in_it() -> None:
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    assert [cell["source"] for cell in cells if cell.get("outputs") or cell.get("execution_count")] == []


@pytest.mark.campaign
def test_it_runs_and_names_the_bent_shaft(tmp_path: Path) -> None:
    made = tmp_path / "made.ipynb"
    command = [sys.executable, "-m", "jupyter", "execute", str(NOTEBOOK), f"--output={made}", "--timeout=600"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stderr[-2000:]
    shown = {
        cell.source.splitlines()[-1]: out["data"]["text/plain"]
        for cell in nbformat.read(made, as_version=4).cells
        if cell.cell_type == "code"
        for out in cell.outputs
        if "text/plain" in out.get("data", {})
    }
    assert shown["diagnosis"].startswith("Diagnosis: named")
    assert "bowed" in shown["diagnosis"].splitlines()[1]
