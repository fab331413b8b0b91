"""The hooks that CONTRIBUTING.md lists for a new effect and a new fault are those of their interfaces."""

import inspect
import re

from rotorrig.sims.effects.base import TARGETS, Effect
from rotorrig.sims.plant.faults.base import Fault
from tests.documents.pages import CODE, text_of


def named(heading: str, listing: str) -> set[str]:
    """Return the names in backquotes in the part of that section that `listing` matches."""
    section = text_of("CONTRIBUTING.md").partition(f"## {heading}\n")[2].partition("\n## ")[0]
    (found,) = re.findall(listing, section, re.DOTALL)
    return set(CODE.findall(found))


def test_the_hooks_of_an_effect_are_those_listed() -> None:
    hooks = named("Add an effect", r"the four hooks (.*?) are\s+for")
    assert hooks == set(TARGETS)
    assert [name for name in sorted(hooks) if not inspect.isfunction(getattr(Effect, name, None))] == []


def test_the_hooks_of_a_fault_are_those_listed() -> None:
    hooks = named("Add a fault of the simulated rig", r"the hooks it needs of (.*?);")
    methods = inspect.getmembers(Fault, inspect.isfunction)
    assert hooks == {name for name, _ in methods if not name.startswith("_")}
