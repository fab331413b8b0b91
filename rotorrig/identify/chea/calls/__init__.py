"""Calls of the user's objective: one or many at a time, in worker processes, failures counted."""

from rotorrig.identify.chea.calls.call import Objective
from rotorrig.identify.chea.calls.evaluation import Evaluation, Map

__all__ = [
    "Evaluation",
    "Map",
    "Objective",
]
