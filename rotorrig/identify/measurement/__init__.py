"""What was measured, as a fit sees it: the 1X or nX rows of a response in standard deviations.

Of the noise found in the data, and of the model's own error once a model is known.
"""

from rotorrig.identify.measurement.falling_angle import told_by_falling_angle
from rotorrig.identify.measurement.model_error import changed_vectors, error_vectors, mark_vectors
from rotorrig.identify.measurement.whitened_rows import SLOW_ROLL, Measurement, measure, trial_unbalance

__all__ = [
    "SLOW_ROLL",
    "Measurement",
    "changed_vectors",
    "error_vectors",
    "mark_vectors",
    "measure",
    "told_by_falling_angle",
    "trial_unbalance",
]
