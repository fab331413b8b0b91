"""Every picture is made by a script: those drawn in seconds are drawn again here, the others say what made them."""

import re
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from docs.make_docs import COSTLY, IMAGES, pictures
from docs.origin import origin_of
from tests.documents.pages import PAGES, links

LINES = re.compile(r'(?<= )d="([MLZ\d. -]*)"')
PLACES = re.compile(r'(?<= )(?:d|x|y|cx|cy)="[^"]*"')  # of what is no line: words, boxes, dots
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
HAIR = 0.11  # px: a last digit, where another machine's linear algebra rounds otherwise
WITHOUT_CONFIG = {"chapter-fig4.svg"}  # of a function
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
    command, code, *config = origin_of(IMAGES / name).split("; ")
    assert command == COSTLY[name]
    assert re.fullmatch(r"rotorrig \d+\.\d+\.\d+(\+[\w.]+)?", code)
    assert len(config) == (name not in WITHOUT_CONFIG)
    assert all(re.fullmatch(r"config [0-9a-f]{16}", each) for each in config)


def test_every_picture_is_on_a_page() -> None:
    shown = {link.rpartition("/")[2] for page in PAGES for link in links(page)}
    assert [name for name in THERE if name not in shown] == []


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ('<path d="M1.0 2.0L3.0 4.0"/>', '<path d="M1.0 2.0L3.0 4.6"/>'),
        ('<path d="M1.0 2.0L3.0 4.0"/>', '<path d="M1.0 2.0L2.0 3.0"/>'),
        ('<path d="M1.0 2.0L3.0 4.0"/>', '<path d="M1.0 2.0L3.0 4.0M5.0 5.0L6.0 6.0"/>'),
        ('<path d="M1.0 2.0L3.0 4.0"/>', '<path d="M1.0 2.0L3.0 4.0Z"/>'),
        ('<path d="M1.0 2.0h0"/>', '<path d="M1.0 2.6h0"/>'),
        ('<text x="1.0">a</text>', '<text x="1.6">a</text>'),
        ('<path d="M1.0 2.0L3.0 4.0" stroke-width="1.5"/>', '<path d="M1.0 2.0L3.0 4.0" stroke-width="1.6"/>'),
        ('<text x="1">0.4</text>', '<text x="1">0.5</text>'),
        ('<text x="1">a1</text>', '<text x="1">b1</text>'),
    ],
)
def test_pictures_that_differ_are_told_apart(one: str, other: str) -> None:
    assert same(one, one)
    assert not same(one, other)


@pytest.mark.parametrize("other", ["M0 0L4 0.1L10 0", "M0 0L10 0", "M0 0L9 0L9 0.1L10 0"])
def test_a_line_is_the_same_wherever_its_corners_are(other: str) -> None:
    assert same('<path d="M0 0L5 0L10 0"/>', f'<path d="{other}"/>')


def same(one: str, other: str) -> bool:
    """Return whether two SVGs are the same but for places less than a hair apart."""
    if form(one) != form(other) or not close(coordinates(one), coordinates(other)):
        return False
    return all(as_near(*lines) for lines in zip(LINES.findall(one), LINES.findall(other), strict=True))


def form(svg: str) -> str:
    """Return all of an SVG but where its places and the corners of its lines are."""
    without_corners = LINES.sub(lambda line: re.sub(r"[^MZ]", "", line[1]), svg)
    return PLACES.sub(lambda place: NUMBER.sub("#", place[0]), without_corners)


def coordinates(svg: str) -> list[float]:
    return [float(number) for place in PLACES.findall(LINES.sub("", svg)) for number in NUMBER.findall(place)]


def close(one: Sequence[float], other: Sequence[float]) -> bool:
    return len(one) == len(other) and all(abs(a - b) < HAIR for a, b in zip(one, other, strict=True))


def as_near(one: str, other: str) -> bool:
    """Return whether every corner of each line lies on the other line."""
    return one == other or all(
        max(apart(corners(a), corners(b)), apart(corners(b), corners(a))) < HAIR
        for a, b in zip(one.split("M")[1:], other.split("M")[1:], strict=True)
    )


def corners(line: str) -> NDArray[np.float64]:
    return np.array(NUMBER.findall(line), dtype=float).reshape(-1, 2)


def apart(points: NDArray[np.float64], line: NDArray[np.float64]) -> float:
    """Return how far the furthest of the points (n, 2) is from a line through corners (m, 2)."""
    along = np.diff(line, axis=0)
    from_corner = points[:, None] - line[None, :-1]
    share = np.einsum("nmk,mk->nm", from_corner, along) / np.maximum((along**2).sum(axis=1), 1e-12)
    away = from_corner - np.clip(share, 0, 1)[..., None] * along
    return float(np.hypot(away[..., 0], away[..., 1]).min(axis=1, initial=np.inf).max(initial=0))
