"""docs/cli.md: every verb of `rotor` with its arguments and options, read from the command itself."""

import inspect
import re
from typing import Any

import typer

from rotorrig.app.cli import app

HEAD = """# Every verb and option

Written by `make docs` from the command itself; do not edit. `rotor VERB --help` says the same. `rotor
--version` shows the version; `rotor --install-completion` sets up completion for the shell in use, and
`--show-completion` prints what it would install. A CONFIG is a TOML file, or the name of one that comes with the
program (`rotor init` lists them) where no file is called so.

A command that cannot do what it was asked says in one sentence what it got, what it wants and where, and ends with a
status other than 0. Angles are from the keyphasor mark in the sense of rotation; amplitudes are 0-peak
([conventions](conventions.md)).

A command never writes to a file it reads, to a device, or over a file of another kind, whatever its name: the kind is
told by the content. An existing file of the same kind is replaced with `--force` alone. This is checked before the work
begins, for `rotor demo` file by file, and a file is written whole or not at all
([more](files.md#when-something-goes-wrong)).
"""
NOTE = re.compile(r"\s*\[((?:required|default|env|x)[^\]]*)\]$")  # what stands in brackets behind an option's help
HELP = "--help"

Command = Any  # typer brings a click of its own, whose classes have no public name


def text() -> str:
    """Return the whole page."""
    every = verbs()
    table = ["| | |", "|---|---|"]
    table += [
        f"| [`rotor {name}`](#rotor-{name.replace(' ', '-')}) | {verb.get_short_help_str(200)} |"
        for name, verb in every.items()
    ]
    return "\n".join([HEAD, *table, "", *(_section(name, verb) for name, verb in every.items())])


def verbs() -> dict[str, Command]:
    """Return the verbs by name, in the order of `rotor --help`; those below another by both names, "lab run"."""
    command: Command = typer.main.get_command(app)
    every: dict[str, Command] = {}
    for name in command.list_commands(None):
        below = getattr(command.commands[name], "commands", {})
        every |= {f"{name} {verb}": found for verb, found in below.items()} or {name: command.commands[name]}
    return every


def split_command(words: list[str]) -> tuple[str, list[str]]:
    """Return the verb of a command's words, "track" or "lab run", and what stands behind it."""
    two = " ".join(words[1:3])
    return (two, words[3:]) if two in verbs() else (words[1], words[2:])


def _section(name: str, verb: Command) -> str:
    context = verb.make_context(f"rotor {name}", ["-"], resilient_parsing=True)
    usage = " ".join(verb.get_usage(context).removeprefix("Usage: ").split())
    lines = [f"## rotor {name}", "", "```", usage, "```", "", inspect.cleandoc(verb.help or "")]
    lines += ["", "| | | |", "|---|---|---|"]
    for parameter in verb.get_params(context):
        shown, words = parameter.get_help_record(context)
        if HELP not in shown:
            note = NOTE.search(words)
            lines.append(f"| `{_cell(shown)}` | {_cell(NOTE.sub('', words))} | {_cell(note[1]) if note else ''} |")
    return "\n".join(lines) + "\n"


def _cell(words: str) -> str:
    return words.replace("|", "\\|")
