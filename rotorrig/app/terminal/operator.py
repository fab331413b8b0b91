"""Operator at the terminal: shows requests, reads replies without blocking; `s` and Enter end a sweep."""

import os
import select
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress

import typer

from rotorrig.acquisition.sweep import Ask, Step
from rotorrig.rig import ConfigError

STOP_WORDS = ("s", "stop")
HINT = "s + Enter stops down the ramp, Ctrl-C aborts, twice is an emergency stop."


class Terminal:
    """An acquisition.operator.Operator who reads and types here; `say` shows a line, over progress bars as well."""

    def __init__(self, *, say: Callable[[str], object], yes: bool = False) -> None:
        """`yes` answers every request at once: for a rehearsal."""
        self._say, self._yes = say, yes
        self._stop = self._answered = False

    def wants_stop(self) -> bool:
        """Return whether `s` was typed."""
        self._listen()
        return self._stop

    def ask(self, request: str) -> None:
        """Show a request to be done at the rotor at rest."""
        self._answered = self._yes
        self._say(f"The rotor is at rest: {request}" + (" (--yes: continuing)" if self._yes else ", then press Enter."))

    def has_answered(self) -> bool:
        """Return whether Enter was pressed since the request."""
        self._listen()
        return self._answered

    def tell(self, text: str) -> None:
        """Show an urgent message."""
        self._say(text)

    def _listen(self) -> None:
        for line in read_typed_lines():
            if line.strip().lower() in STOP_WORDS:
                self._stop = True
            elif not line.strip():
                self._answered = True


def operator_for(steps: Sequence[Step], *, say: Callable[[str], object], yes: bool) -> Terminal:
    """Return the operator for these steps. Raises ConfigError if they contain requests and there is no terminal."""
    asks = any(isinstance(step, Ask) for step in steps)
    if asks and not yes and not sys.stdin.isatty():
        raise ConfigError(
            "the plan asks for trial masses to be mounted and there is no terminal to confirm at; want one, or --yes "
            "for a rehearsal without them"
        )
    return Terminal(say=say, yes=yes)


def confirm(request: str, *, yes: bool) -> None:
    """Ask for a yes at the terminal before the rotor is turned; `yes` is one. Raises ConfigError without it."""
    if yes:
        return
    if not sys.stdin.isatty():
        raise ConfigError("there is no terminal to confirm at that the rotor may be turned; want one, or --yes")
    if not typer.confirm(request, err=True):
        raise ConfigError("not confirmed; nothing was turned")


def read_typed_lines() -> list[str]:
    """Return what was typed at the terminal since the last call, line by line; never waits.

    Nothing where standard input is no terminal, or is another program's at the moment: reading it would stop this one.
    """
    with suppress(OSError, ValueError):  # closed, or the terminal is gone
        number = sys.stdin.fileno()
        if not os.isatty(number) or os.tcgetpgrp(number) != os.getpgrp():
            return []
        if select.select([number], [], [], 0)[0]:
            return os.read(number, 4096).decode(errors="replace").split("\n")[:-1]
    return []
