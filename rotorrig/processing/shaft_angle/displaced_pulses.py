"""Reject keyphasor pulses triggered early by a noise spike.

Each pulse is held against the cubic through the two before and the two after it, in angle. One that is displaced by d
is off by d, and its neighbours by minus their share of it, 2/3 where pulses are evenly spaced; a shaft that speeds up
or slows down at once leaves no such pattern.
"""

from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from rotorrig.processing.shaft_angle.pulse_train import PulseTrain

FAR = 8.0  # times what pulses are usually off by: no timing error
LEAST = 0.005  # of the step to the next pulse: less does no harm
ALIKE = 0.25  # of the displacement: how far its neighbours may be from their share of it
NEIGHBOURS = 33  # pulses that tell what is usual


def drop_displaced(train: PulseTrain, angle: NDArray[np.float64]) -> PulseTrain:
    """Drop displaced pulses among those at `angle` (pulse,) [rad]; each counts as an extra and as a missed one."""
    wrong = np.zeros(len(train.t), dtype=bool)
    if len(train.t) >= 7:  # a pulse with two on either side, whose neighbours have them too
        wrong[3:-3] = _find_displaced(train.t, angle)
    if not wrong.any():
        return train
    kept = np.flatnonzero(~wrong)
    number = train.number[kept]
    in_gap, uncounted = (np.add.reduceat(steps, kept[:-1]) > 0 for steps in (train.in_gap, train.uncounted))
    return replace(
        train,
        t=train.t[kept],
        number=number,
        extra=(*train.extra, *train.t[wrong].tolist()),
        missed=(np.diff(number) > 1) & ~in_gap,
        uncounted=uncounted,
        in_gap=in_gap,
    )


def _find_displaced(t: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the mask of displaced pulses, without the first and last three."""
    share = _weights(sliding_window_view(angle, 5))  # (pulse - 4, neighbour)
    window = sliding_window_view(t, 5) - t[2:-2, None]
    off = -np.einsum("kn,kn->k", share, window[:, [0, 1, 3, 4]])
    usual = median_filter(np.abs(off), NEIGHBOURS, mode="mirror") / 0.6745
    far = np.abs(off) > np.maximum(FAR * usual, LEAST * (t[3:-1] - t[2:-2]))
    before, after = off[:-2] + share[:-2, 2] * off[1:-1], off[2:] + share[2:, 1] * off[1:-1]
    return far[1:-1] & (np.maximum(np.abs(before), np.abs(after)) < ALIKE * np.abs(off[1:-1]))


def _weights(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Lagrange's weights (pulse, 4) at the middle of five angles (pulse, 5) of the other four."""
    others = angle[:, [0, 1, 3, 4]] - angle[:, 2, None]
    weights = np.ones_like(others)
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[:, i] *= others[:, j] / (others[:, j] - others[:, i])
    return weights
