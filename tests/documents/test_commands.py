"""Every command that a page shows or names is one: of `rotor`, of make, of python.

Those of README.md, docs/your-data.md and docs/tutorial.md are run: tests/end_to_end/test_documents.py.
"""

import importlib.util
import re
from typing import Any

import pytest
import typer

from docs.cli_reference import split_command, verbs
from tests.documents.pages import PAGES, ROOT, commands, mentioned, shell_lines, text_of

VERBS = verbs()
TARGETS = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))


def parse(words: list[str]) -> Any:
    """Let the command's own parser read a command. Raises its error."""
    verb, rest = split_command(words)
    assert verb in VERBS, f"rotor has no verb '{verb}'"
    return VERBS[verb].make_context(verb, rest)


@pytest.mark.parametrize("page", PAGES)
def test_every_command_of_a_page_is_understood(page: str) -> None:
    for words in commands(page):
        if words[1:] not in (["--help"], ["--version"], ["--install-completion"]):
            parse(words)


@pytest.mark.parametrize("page", PAGES)
def test_the_verbs_and_options_that_a_page_names_exist(page: str) -> None:
    unknown = []
    for verb, rest in map(split_command, mentioned(page, "rotor")):
        if verb.startswith("-") or not verb.islower():
            continue
        context = VERBS[verb].make_context(verb, [], resilient_parsing=True)
        known = {name for parameter in VERBS[verb].get_params(context) for name in parameter.opts}
        unknown += [f"rotor {verb} {word}" for word in rest if word.startswith("-") and word.split("=")[0] not in known]
    assert unknown == []


@pytest.mark.parametrize("page", PAGES)
def test_the_targets_of_make_that_a_page_names_exist(page: str) -> None:
    named = [words for words in [*shell_lines(page), *mentioned(page, "make")] if words[0] == "make"]
    wanted = [word for words in named for word in words[1:] if "=" not in word and not word.startswith("-")]
    assert [target for target in wanted if target not in TARGETS] == []


@pytest.mark.parametrize("page", PAGES)
def test_the_programs_that_a_page_names_exist(page: str) -> None:
    text = text_of(page)
    assert [name for name in re.findall(r"\bpython -m ([\w.]+)", text) if not importlib.util.find_spec(name)] == []
    scripts = re.findall(r"\b((?:docs|benchmarks|tests|rotorrig|firmware)/[\w/-]+\.(?:py|toml|json|c|h))\b", text)
    assert [script for script in scripts if not (ROOT / script).exists()] == []


@pytest.mark.parametrize(
    "command", ["rotor swep my.toml", "rotor sweep my.toml --viw", "rotor track run.mcap", "rotor check"]
)
def test_a_command_that_is_none_is_found(command: str) -> None:
    with pytest.raises((AssertionError, typer._click.exceptions.UsageError)):
        parse(command.split())
