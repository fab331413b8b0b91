"""Order phasors read off a plant's volts with nothing but its keyphasor channel; no code of processing."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.plant.plant import Plant

RPM = np.pi / 30  # rad/s


def falling_edges(volts: NDArray[np.float64], *, level: float = -13.0) -> NDArray[np.float64]:
    """Return fractional sample indices at which `volts` fall through `level`, between neighbouring samples."""
    before = np.flatnonzero((volts[:-1] > level) & (volts[1:] <= level))
    return before + (level - volts[before]) / (volts[before + 1] - volts[before])


def order_phasors(volts: NDArray[np.float64], *, order: int) -> NDArray[np.complex128]:
    """Return z = 2 mean(x e^{-j n theta}) over whole turns (channel,) of all but the last channel, the keyphasor.

    theta = 0 at its falling edges.
    """
    edges = falling_edges(volts[:, -1])
    theta = 2 * np.pi * np.interp(np.arange(len(volts)), edges, np.arange(len(edges)))
    inside = slice(int(np.ceil(edges[0])), int(np.ceil(edges[-1])))
    x = volts[inside, :-1] - volts[inside, :-1].mean(axis=0)
    return 2 * np.mean(x * np.exp(-1j * order * theta[inside])[:, None], axis=0)


def volts_of(plant: Plant, t: float) -> NDArray[np.float64]:
    """Return the volts (sample, channel) of the next `t` seconds."""
    return plant.advance(plant.t + t) * np.array(plant.volts_per_count)


def measured(plant: Plant, t: float, *, order: int = 1) -> NDArray[np.complex128]:
    """Return the order phasors (probe,) [m] of the next `t` seconds, sensitivities as on the nameplate."""
    return order_phasors(volts_of(plant, t), order=order) / 7874.0
