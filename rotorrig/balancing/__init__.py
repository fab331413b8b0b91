"""Balancing: which mass to put where, by influence coefficients, by the fitted model, or by both.

`conditions` brings runs with trial masses onto common speeds; `influence` and `fitted_model` make vibration a linear
function of the masses, with errors; `correction`, `min_max` and `discrete` choose masses; `determinacy` says which
combination the data do not determine, `prediction` what the next run will show, `grade` what the standard calls it.
"""

from rotorrig.balancing.balance import Balance, Task, balance
from rotorrig.balancing.balance_file import balance_table, write_balance, write_prediction
from rotorrig.balancing.balance_reader import read_balance
from rotorrig.balancing.correction import Correction, least_squares_correction
from rotorrig.balancing.determinacy import Combination, Determinacy
from rotorrig.balancing.discrete import Holes, Placing
from rotorrig.balancing.fitted_model import influence_of_fit
from rotorrig.balancing.grade import Grade
from rotorrig.balancing.influence import INFLUENCE, MODEL, Influence
from rotorrig.balancing.prediction import DIRECTIONS, Comparison, Prediction, predict_vibration

__all__ = [
    "DIRECTIONS",
    "INFLUENCE",
    "MODEL",
    "Balance",
    "Combination",
    "Comparison",
    "Correction",
    "Determinacy",
    "Grade",
    "Holes",
    "Influence",
    "Placing",
    "Prediction",
    "Task",
    "balance",
    "balance_table",
    "influence_of_fit",
    "least_squares_correction",
    "predict_vibration",
    "read_balance",
    "write_balance",
    "write_prediction",
]
