"""Slow-roll vector and waveform: find a slow stretch, average it, check how much of it is response to unbalance."""

from rotorrig.processing.slow_roll.checks import FirstOrder, validity_remarks
from rotorrig.processing.slow_roll.find import add_slow_roll, chosen_rows

__all__ = [
    "FirstOrder",
    "add_slow_roll",
    "chosen_rows",
    "validity_remarks",
]
