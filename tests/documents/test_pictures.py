"""Every picture is made by a script: those drawn in seconds are drawn again here, the others say what made them."""

import re
from functools import cache

import pytest

from docs.make_docs import COSTLY, IMAGES, pictures
from docs.origin import origin_of
from tests.documents.pages import PAGES, links

NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
HAIR = 0.11  # px: a last digit, where another machine's linear algebra rounds otherwise
THERE = sorted(path.name for path in IMAGES.iterdir())


@cache
def drawn() -> dict[str, str]:
    return {name: figure.text() for name, figure in pictures().items()}


def test_every_picture_has_a_script_and_every_script_its_pictures() -> None:
    assert sorted([*drawn(), *COSTLY]) == THERE


def test_the_pictures_drawn_in_seconds_are_those_of_the_code() -> None:
    stale = [name for name, text in drawn().items() if not same(text, (IMAGES / name).read_text(encoding="utf-8"))]
    assert stale == [], "run `make docs`"


@pytest.mark.parametrize("name", COSTLY)
def test_every_other_picture_says_what_made_it(name: str) -> None:
    command, code, config = origin_of(IMAGES / name).split("; ")
    assert command == COSTLY[name]
    assert re.fullmatch(r"rotorrig \d+\.\d+\.\d+(\+[\w.]+)?", code)
    assert re.fullmatch(r"config [0-9a-f]{16}", config)


def test_every_picture_is_on_a_page() -> None:
    shown = {link.rpartition("/")[2] for page in PAGES for link in links(page)}
    assert [name for name in THERE if name not in shown] == []


@pytest.mark.parametrize(("one", "other"), [("M1.0 2.0", "M1.0 2.2"), ("M1.0 2.0", "M1.0 2.0L3.0 4.0"), ("a1", "b1")])
def test_pictures_that_differ_are_told_apart(one: str, other: str) -> None:
    assert same(one, one)
    assert not same(one, other)


def same(one: str, other: str) -> bool:
    """Return whether two SVGs are the same but for the last digit of a place."""
    if NUMBER.split(one) != NUMBER.split(other):
        return False
    places = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    return all(abs(float(a) - float(b)) < HAIR for a, b in places)
