"""`rotor balance` and `rotor predict`: read responses and options, balance or predict, print and write the result."""

from rotorrig.app.commands.balancing.balance import balance_responses, read_task, show_balance
from rotorrig.app.commands.balancing.options import HoleOptions, read_radii
from rotorrig.app.commands.balancing.predict import (
    predict_by_fit,
    predict_with_masses,
    show_prediction,
    write_predicted,
)

__all__ = [
    "HoleOptions",
    "balance_responses",
    "predict_by_fit",
    "predict_with_masses",
    "read_radii",
    "read_task",
    "show_balance",
    "show_prediction",
    "write_predicted",
]
