"""docs/chea.md cannot lie: its code runs, its pictures are there."""

import re
from pathlib import Path

DOCUMENT = Path(__file__).parents[3] / "docs" / "chea.md"


def test_the_code_of_the_document_runs() -> None:
    names: dict[str, object] = {}
    blocks = re.findall(r"^```python\n(.*?)^```$", DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert len(blocks) == 3
    for block in blocks:
        exec(block, names)


def test_every_picture_of_the_document_is_there_and_used() -> None:
    shown = set(re.findall(r"\]\((img/[^)]+)\)", DOCUMENT.read_text(encoding="utf-8")))
    drawn = {f"img/{path.name}" for path in (DOCUMENT.parent / "img").glob("chea-*")}
    assert shown == drawn
