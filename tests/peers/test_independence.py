"""The peers share no code with what they are to judge."""

import ast
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).parent
PEERS = sorted(path for path in HERE.glob("*.py") if not path.name.startswith("test_"))


def imported(path: Path) -> Iterator[str]:
    """Yield the modules that a file imports, wherever in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) == "import_module":
            yield ast.unparse(node.args[0])


def test_no_file_here_or_of_the_campaign_imports_rotorrig() -> None:
    files = sorted([*HERE.glob("*.py"), *(HERE.parent / "campaign").glob("*.py")])
    assert len(files) > len(PEERS) + 5
    assert [(path.name, name) for path in files for name in imported(path) if "rotorrig" in name] == []


def test_a_peer_imports_peers_and_libraries_alone() -> None:
    assert len(PEERS) > 5
    own = [
        (path.name, name) for path in PEERS for name in imported(path) if name.split(".")[0] in ("tests", "benchmarks")
    ]
    assert [(path, name) for path, name in own if not name.startswith("tests.peers.")] == []
