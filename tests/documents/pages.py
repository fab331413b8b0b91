"""The pages of the documentation, and what is in them: commands, blocks, links, headings."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    *sorted(f"docs/{path.name}" for path in ROOT.glob("docs/*.md")),
)
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`([^`]+)`")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
NO_COMMAND = ("...", "VERB")


def text_of(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def blocks(page: str, kind: str) -> list[str]:
    """Return the fenced blocks of that language."""
    return [text for found, text in BLOCK.findall(text_of(page)) if found == kind]


def prose(page: str) -> str:
    """Return a page without its fenced blocks."""
    return BLOCK.sub("", text_of(page))


def commands(page: str) -> list[list[str]]:
    """Return the words of each `rotor` command in the shell blocks of a page."""
    return [words for words in shell_lines(page) if words[0] == "rotor"]


def shell_lines(page: str) -> list[list[str]]:
    """Return the words of each line of the shell blocks, comments left out."""
    lines = "".join(blocks(page, "sh")).replace("\\\n", " ").splitlines()
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def mentioned(page: str, program: str) -> Iterator[list[str]]:
    """Yield the words of what stands in backquotes and begins with `program`, but for placeholders of commands."""
    for code in CODE.findall(prose(page)):
        if code.split()[:1] == [program]:
            words = shlex.split(" ".join(code.split()))
            if len(words) > 1 and not set(NO_COMMAND) & set(words):
                yield words


def links(page: str) -> list[str]:
    """Return what a page links to, other sites left out."""
    return [link for link in LINK.findall(prose(page)) if "://" not in link]


def anchors(page: str) -> set[str]:
    """Return the anchors of the headings, made as GitHub makes them."""
    found: dict[str, int] = {}
    for heading in HEADING.findall(prose(page)):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        slug = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        found[slug] = found.get(slug, -1) + 1
        if found[slug]:
            found[f"{slug}-{found[slug]}"] = 0
    return set(found)
