"""Every link of every page leads somewhere, and every page is in the index."""

import re

import pytest

from tests.documents.pages import PAGES, ROOT, anchors, links, prose, text_of

INDEX = "docs/README.md"


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_links_to_is_there(page: str) -> None:
    place = (ROOT / page).parent
    assert [link for link in links(page) if not (place / link.partition("#")[0]).exists()] == []


@pytest.mark.parametrize("page", PAGES)
def test_the_heading_a_page_links_to_is_there(page: str) -> None:
    missing = []
    for link in links(page):
        target, _, anchor = link.partition("#")
        if anchor:
            other = (ROOT / page).parent / target if target else ROOT / page
            if anchor not in anchors(str(other.resolve().relative_to(ROOT))):
                missing.append(link)
    assert missing == []


@pytest.mark.parametrize("page", PAGES)
def test_the_page_a_page_names_is_there(page: str) -> None:
    named = re.findall(r"\b(?:docs/)?[\w-]+\.md\b", prose(page))
    assert [name for name in named if not ((ROOT / name).exists() or (ROOT / "docs" / name).exists())] == []


def test_the_index_has_every_page_once_and_a_line_on_it() -> None:
    rows = re.findall(r"^\| \[[^\]]+\]\(([\w-]+\.md)\) \| (.+) \|$", text_of(INDEX), re.MULTILINE)
    assert sorted(f"docs/{name}" for name, _ in rows) == sorted(
        page for page in PAGES if page.startswith("docs/") and page != INDEX
    )
    assert all(line.strip() for _, line in rows)


def test_the_front_page_leads_to_the_index() -> None:
    assert INDEX in links("README.md")
