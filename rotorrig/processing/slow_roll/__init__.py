"""The slow-roll vector and waveform: find a slow stretch, average it, check how much of it is response to unbalance."""

from rotorrig.processing.slow_roll.checks import FirstOrder, validity
from rotorrig.processing.slow_roll.find import chosen_rows, with_slow_roll

__all__ = [
    "FirstOrder",
    "chosen_rows",
    "validity",
    "with_slow_roll",
]
