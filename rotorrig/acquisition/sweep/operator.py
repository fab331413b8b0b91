"""Operator of a sweep: the person at the rig, as far as the engine needs one."""

from collections.abc import Callable
from contextlib import suppress
from typing import Protocol


class Operator(Protocol):
    """Person who is asked and told things and may end the sweep. No method may wait: they are called between blocks."""

    def wants_stop(self) -> bool:
        """Return True if the sweep should end here, down the ramp."""
        ...

    def ask(self, request: str) -> None:
        """Ask for something to be done at the rotor at rest."""
        ...

    def has_answered(self) -> bool:
        """Return True once it has been done."""
        ...

    def tell(self, text: str) -> None:
        """Say something that cannot wait until the sweep is over."""
        ...


class Nobody:
    """Operator of a sweep that nobody watches: asked for something, it never answers."""

    def wants_stop(self) -> bool:
        """Never."""
        return False

    def ask(self, request: str) -> None:
        """Do nothing."""

    def has_answered(self) -> bool:
        """Never."""
        return False

    def tell(self, text: str) -> None:
        """Do nothing: the recording has it, and the sweep's error."""


class Steadfast:
    """An operator whose terminal may die: what it raises ends in the wish to stop, never in the sweep's loop."""

    def __init__(self, operator: Operator) -> None:
        self.fault = ""  # what went wrong first; empty: nothing
        self._operator = operator

    def wants_stop(self) -> bool:
        """Return True if the sweep should end here: asked for, or nobody can be heard any more."""
        return bool(self.attempt(self._operator.wants_stop)) or bool(self.fault)

    def ask(self, request: str) -> None:
        """Ask for something to be done at the rotor at rest."""
        self.attempt(lambda: self._operator.ask(request))

    def has_answered(self) -> bool:
        """Return True once it has been done."""
        return bool(self.attempt(self._operator.has_answered))

    def tell(self, text: str) -> None:
        """Say something that cannot wait until the sweep is over. Never raises: the rotor is being stopped."""
        with suppress(Exception):
            self._operator.tell(text)

    def attempt(self, act: Callable[[], object]) -> object:
        """Do something at the terminal; return its result, None if the terminal is gone."""
        try:
            return act()
        except (OSError, ValueError) as error:  # ValueError: a closed file
            self.fault = self.fault or f"the terminal cannot be reached ({type(error).__name__}: {error})"
            return None
