"""Conditions of a made-up linear rotor: vibration y = b + H W, with noise drawn by numpy alone."""

import numpy as np

from rotorrig.balancing.conditions import Conditions
from rotorrig.rig.config.prior import Prior

PRIOR = Prior(probe_linearity=0.0)  # vectors of about a metre, which no probe reads


def conditions_of(
    b: np.ndarray,
    H: np.ndarray,
    trial: np.ndarray,
    *,
    errors: np.ndarray | None = None,
    variance: float = 0.0,
    planes: tuple[str, ...] = ("one", "two"),
) -> Conditions:
    """Return conditions of vectors b (probe,) and H (probe, plane), masses (condition, plane), at a single speed."""
    z = b + trial @ H.T
    if errors is not None:
        z = z + errors
    return Conditions(
        probes=tuple(f"p{i}" for i in range(len(b))),
        planes=planes[: trial.shape[1]],
        names=tuple(f"run {i}" for i in range(len(trial))),
        trial=trial.astype(complex),
        omega=np.array([300.0]),
        direction=np.array([0]),
        z=z[:, None, :],
        variance=np.full((len(trial), 1, len(b)), variance),
        compensated=True,
    )
