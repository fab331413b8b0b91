"""The figures of docs/chea.md: those of docs/chea-tables.md, read from that page, so that the two cannot differ."""

import re
from pathlib import Path

TABLES = Path(__file__).with_name("chea-tables.md")
BEGIN, END = "<!-- figures of chea-tables.md: written by `make docs` -->", "<!-- end of the figures -->"
ROWS = {"CHEA modern": '`profile="modern"`', "CHEA seed": '`profile="seed"`', "CHEA, the chapter's": "the chapter"}

Cells = dict[str, str]  # column -> what it says


def shown(text: str) -> str:
    """Return the text of chea.md with what stands between its marks made anew."""
    before, rest = text.split(BEGIN)
    return f"{before}{BEGIN}\n\n{table(TABLES.read_text(encoding='utf-8'))}\n\n{END}{rest.split(END)[1]}"


def table(page: str) -> str:
    """Return the mean calls of either profile and of the chapter on every function of the page."""
    found = functions(page)
    lines = [f"| mean calls, {runs_of(page)} runs | {' | '.join(found)} |", f"|---|{'--:|' * len(found)}"]
    for name, title in ROWS.items():
        lines.append(f"| {title} | {' | '.join(_cell(rows.get(name)) for rows in found.values())} |")
    return "\n".join(lines)


def functions(page: str) -> dict[str, dict[str, Cells]]:
    r"""Return the rows of every function's table, by its short name and by the method.

    >>> functions("| f1, a b | calls |\n|---|--:|\n| CHEA seed | 9 |")
    {'f1': {'CHEA seed': {'calls': '9'}}}
    """
    found: dict[str, dict[str, Cells]] = {}
    for block in re.findall(r"^\| f\d\w?, .*(?:\n\|.*)*", page, re.MULTILINE):
        head, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in block.split("\n"))
        found[head[0].partition(",")[0]] = {row[0]: dict(zip(head[1:], row[1:], strict=True)) for row in rows}
    return found


def runs_of(page: str) -> str:
    """Return how many runs the figures of CHEA are of."""
    return re.findall(r"(\d+) runs of CHEA", page)[0]


def _cell(row: Cells | None) -> str:
    """Return the calls, and the runs that list all global minima where that is not every one.

    >>> _cell({"calls": "1,660", "all global": "86 %"}), _cell({"calls": "9", "all global": "100 %"}), _cell(None)
    ('1,660 (86 %)', '9', '')
    """
    if row is None:
        return ""
    share = row.get("all global", "")
    return row["calls"] + (f" ({share})" if share not in ("", "100 %") else "")
