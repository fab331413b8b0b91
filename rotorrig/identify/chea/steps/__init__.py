"""Steps both profiles share: sampling, nearest-better clustering, SQP with its box QP, far search."""

from rotorrig.identify.chea.steps.box_qp import minimize_on_box
from rotorrig.identify.chea.steps.far_search import farthest
from rotorrig.identify.chea.steps.nearest_better_clustering import heads
from rotorrig.identify.chea.steps.sampling import far_points, spread
from rotorrig.identify.chea.steps.sqp import descend

__all__ = [
    "descend",
    "far_points",
    "farthest",
    "heads",
    "minimize_on_box",
    "spread",
]
