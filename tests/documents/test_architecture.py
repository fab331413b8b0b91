"""The functions and files that docs/architecture.md leads to are there, under those names."""

import ast
import re

import pytest

from tests.documents.pages import ROOT, text_of

PAGE = "docs/architecture.md"
STEPS = re.findall(r"^\| [^|]+ \| ([^|]+) \| `(rotorrig/[\w/.]+)` \|$", text_of(PAGE), re.MULTILINE)
CODE = re.compile(r"`([^`]+)`")


def defined_in(place: str) -> set[str]:
    """Return the functions, classes, methods and constants of a file, or of all files of a folder."""
    path = ROOT / place
    names: set[str] = set()
    for file in path.rglob("*.py") if path.is_dir() else [path]:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        names |= {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)}
        for node in tree.body:
            if isinstance(node, ast.Assign | ast.AnnAssign):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                names |= {target.id for target in targets if isinstance(target, ast.Name)}
    return names


@pytest.mark.parametrize(("functions", "place"), STEPS, ids=[place for _, place in STEPS])
def test_a_step_of_a_sweep_is_where_the_page_says(functions: str, place: str) -> None:
    named = {part for name in CODE.findall(functions) for part in name.split(".")}
    assert named - defined_in(place) == set()


def test_every_folder_of_the_program_is_on_the_map() -> None:
    drawn = set(CODE.findall("".join(re.findall(r"^\| `[^|]+\|[^|]+\|", text_of(PAGE), re.MULTILINE))))
    stages = {path.parent.name for path in ROOT.glob("rotorrig/*/__init__.py")} - {"sims"}
    parts = {f"sims/{path.parent.name}" for path in ROOT.glob("rotorrig/sims/*/__init__.py")}
    assert (stages | parts) - drawn == set()


def test_the_files_named_are_there() -> None:
    assert len(STEPS) > 20
    named = set(re.findall(r"`((?:rotorrig|tests|benchmarks|docs)/[\w/.-]*)`", text_of(PAGE)))
    assert len(named) > 30
    assert sorted(path for path in named if not (ROOT / path).exists()) == []
