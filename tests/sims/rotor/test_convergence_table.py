"""The convergence tables of docs/rotor-model.md are those of the code: their coarser rows, computed anew."""

import pytest

from docs.make_convergence import BEGIN, CASES, DOCUMENT, END, LENGTHS, Case, line, rows
from tests.parameters import defer_rest

ROUNDING = 0.06  # of a printed error: its two digits, and another machine's last bits


def numbers(row: str) -> list[float]:
    return [float(cell) for cell in row.strip("| ").split("|")]


@pytest.mark.parametrize("case", defer_rest(CASES), ids=lambda case: case.config.stem)
def test_the_document_says_what_the_code_computes(case: Case) -> None:
    tables = DOCUMENT.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]
    printed = tables.partition(f"**{case.title}**")[2].split("\n\n", maxsplit=2)[1].splitlines()[3:]
    assert len(printed) == len(LENGTHS)
    for row, text in zip(rows(case, LENGTHS[:3]), printed, strict=False):
        assert numbers(text) == pytest.approx(numbers(line(row)), rel=ROUNDING), "run docs/make_convergence.py"
