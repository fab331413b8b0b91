"""Operator of a sweep: the person at the rig, as far as the engine needs one."""

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
