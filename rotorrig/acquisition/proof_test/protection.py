"""A protection that software can provoke, and how soon it has to answer."""

from collections.abc import Callable
from dataclasses import dataclass

from rotorrig.acquisition.proof_test.stage import Stage


@dataclass(frozen=True, slots=True, kw_only=True)
class Protection:
    """One part of the test; a new protection is one in a file of its own."""

    name: str
    provocation: str  # what is done to it, for a person
    provoke: Callable[[Stage], None]
    answers_within: Callable[[Stage], float]  # s, until the stop is decided
    #: how the reason begins for which the program stops the rotor; empty: the drive has to do it by itself
    reason: str
    missing: Callable[[Stage], str] = lambda stage: ""  # why it is not there to be tested; empty: it is

    @property
    def is_the_drives(self) -> bool:
        """Whether the drive has to stop the rotor by itself."""
        return not self.reason
