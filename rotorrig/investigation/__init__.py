"""Investigation: which run to make next, and what was believed after each, until the rig is understood or time is up.

`menu` writes the runs there are to choose from into the config, `choice` takes the next one by the last diagnosis and
the `budget`, `beliefs` says how probable each cause was, `journal` is the file by which a killed investigation goes on.
What makes the runs is app/commands/investigate.py.
"""

from rotorrig.investigation.beliefs import NOTHING_KNOWN, NOTHING_MORE, Belief, beliefs
from rotorrig.investigation.budget import Budget, read_budget
from rotorrig.investigation.choice import Choice, Ending, choose, not_possible
from rotorrig.investigation.journal import Journal, Round, read_journal, write_journal
from rotorrig.investigation.menu import Menu, add_runs

__all__ = [
    "NOTHING_KNOWN",
    "NOTHING_MORE",
    "Belief",
    "Budget",
    "Choice",
    "Ending",
    "Journal",
    "Menu",
    "Round",
    "add_runs",
    "beliefs",
    "choose",
    "not_possible",
    "read_budget",
    "read_journal",
    "write_journal",
]
