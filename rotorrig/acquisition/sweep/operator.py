"""The person at the rig, as far as a sweep needs one."""

from typing import Protocol


class Operator(Protocol):
    """Is asked, told, and may end the sweep. None of it may wait: it is called between two blocks."""

    def wants_stop(self) -> bool:
        """Whether the sweep shall end here, down the ramp."""
        ...

    def ask(self, request: str) -> None:
        """Ask for something to be done at the rotor at rest."""
        ...

    def has_answered(self) -> bool:
        """Whether it has been done."""
        ...

    def tell(self, text: str) -> None:
        """Say something that cannot wait until the sweep is over."""
        ...


class Nobody:
    """An operator for sweeps that nobody watches: asked for something, it never answers."""

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
