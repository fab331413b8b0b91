"""Sign of a table's phases: whether its rotor whirls the way it turns, and lags more beyond a resonance.

A complex table may be of x = Re(z exp(j theta)) or of its conjugate, a phase may be a lead or a lag, and a wrong sign
fits no rotor. Unbalance whirls forward, and its lag grows by some 180 degrees through a resonance; a table that shows
the contrary is remarked upon, not refused: a shaft may whirl backward between two critical speeds.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.probe_planes import measured_planes, whirl
from rotorrig.processing.response import OrderTrackedResponse

BACKWARD = 4.0  # times the square of the forward whirl, over all rows
PEAK = 3.0  # times the median amplitude: less is no resonance to tell the sign by
FEWEST = 5  # rows between the half heights of a peak
TURNED = np.pi / 4  # rad by which a phase leads more above a peak than below

QUESTION = "is the sign of the phases right (phase_is or conjugated of the mapping, rotation of the config)?"


def sign_remark(response: OrderTrackedResponse) -> str:
    """Return what speaks against the sign of the phases, empty if nothing does."""
    if 1.0 not in response.orders or response.amplitudes_alone:
        return ""
    z = np.where(response.usable, response.order(1.0), np.nan)
    for plane, pair in measured_planes(response.rig, response.read):
        places = [response.probes.index(response.read[i]) for i in pair]
        forward, backward = whirl(plane, z[:, places], rotation=response.rig.rotation)
        if np.nansum(np.abs(backward) ** 2) > BACKWARD * np.nansum(np.abs(forward) ** 2):
            return f"the vectors of {', '.join(plane.probes)} whirl backward, {QUESTION}"
    for name in response.read:
        p = response.probes.index(name)
        for i, run in enumerate(response.runs):
            rows = np.flatnonzero((response.run == i) & np.isfinite(z[:, p]))
            if run.direction and _leads_beyond(response.omega[rows], z[rows, p]):
                return f"the vectors of {name} lag less beyond their peak than before it, {QUESTION}"
    return ""


def _leads_beyond(omega: NDArray[np.float64], z: NDArray[np.complex128]) -> bool:
    """Return True if the phase of z (row,) rises with the speed through its peak, from half height to half height."""
    z = z[np.argsort(omega)]
    size = np.abs(z)
    if len(z) < FEWEST or size.max() < PEAK * np.median(size):
        return False
    peak = int(np.argmax(size))
    low = np.flatnonzero(size[:peak] < size[peak] / 2)
    high = np.flatnonzero(size[peak:] < size[peak] / 2)
    if not (len(low) and len(high)):
        return False
    phase = np.unwrap(np.angle(z[low[-1] : peak + high[0] + 1]))
    return len(phase) >= FEWEST and bool(phase[-1] - phase[0] > TURNED)
