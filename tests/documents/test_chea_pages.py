"""The pages on CHEA: one source for every figure, and choices that are those of the code."""

import re
from itertools import chain

import pytest

from docs.chea_choices import ROOT, SECTIONS, Choice
from docs.chea_figures import TABLES, functions, table
from rotorrig.identify.chea import SEED
from tests.documents.pages import text_of

CHOICES = list(chain.from_iterable(SECTIONS.values()))


@pytest.mark.parametrize("choice", CHOICES, ids=lambda choice: choice.chapter[:40])
def test_a_choice_says_why_and_stands_in_the_file_it_names(choice: Choice) -> None:
    assert choice.here and choice.because
    code = (ROOT / choice.file).read_text(encoding="utf-8")
    assert [name for name in choice.names if not re.search(rf"\b{name}\b", code)] == []


def test_what_the_chapter_leaves_open_is_told() -> None:
    page = text_of("docs/chea-choices.md")
    assert f"| {SEED.bits} bits for each parameter" in page
    for word in ("scale of a variable", "tolerances", "line search", "selection", "similarity", "finite differences"):
        assert word in page


def test_the_figures_of_chea_are_those_of_its_tables() -> None:
    found = functions(TABLES.read_text(encoding="utf-8"))
    assert list(found) == ["f1", "f2", "f3", "f1s", "f2s", "f3s", "f3r"]
    rows = table(TABLES.read_text(encoding="utf-8")).splitlines()
    assert rows[2].split("|")[2].strip() == found["f1"]["CHEA modern"]["calls"]
    assert rows[-1].split("|")[2:5] == [" 1,120 ", " 1,131 ", " 2,100 (99 %) "]


def test_figures_of_runs_stand_on_generated_pages_alone() -> None:
    by_hand = re.sub(r"<!-- figures.*?<!-- end of the figures -->", "", text_of("docs/chea.md"), flags=re.DOTALL)
    calls = {row["calls"] for rows in functions(TABLES.read_text(encoding="utf-8")).values() for row in rows.values()}
    assert not set(re.findall(r"\d,\d{3}", by_hand)) & calls
