"""docs/chea.md cannot lie: its code runs."""

import re
from pathlib import Path

DOCUMENT = Path(__file__).parents[3] / "docs" / "chea.md"


def test_the_code_of_the_document_runs() -> None:
    names: dict[str, object] = {}
    blocks = re.findall(r"^```python\n(.*?)^```$", DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert len(blocks) == 3
    for block in blocks:
        exec(block, names)
