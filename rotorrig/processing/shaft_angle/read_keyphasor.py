"""Read a recording's keyphasor channel into the shaft angle, by the config's threshold, hysteresis, edge and pulses."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.shaft_angle.edges import EdgeFinder, LevelFinder, Levels
from rotorrig.processing.shaft_angle.shaft_angle import ShaftAngle, fit_shaft_angle
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig import DataError
from rotorrig.rig.config import Keyphasor

HYSTERESIS = 0.25  # of the distance from the threshold to the nearer level: half of the band about the threshold


def read_keyphasor(waveforms: Waveforms) -> ShaftAngle:
    """Return the shaft angle by the config's keyphasor; the threshold is midway between the levels unless given.

    Raises DataError if there are no pulses, too few, or too many at the wrong time, or if the config's threshold and
    hysteresis do not lie between the levels.
    """
    keyphasor = waveforms.keyphasor
    where = f"{waveforms.where}: keyphasor (channel {keyphasor.channel})"
    finder = LevelFinder(waveforms.rate, where=where)
    for first, volts in waveforms.keyphasor_pieces():
        finder.take(first, volts)
    edges = _edges(waveforms, keyphasor, finder.levels(), where=where)
    return fit_shaft_angle(
        edges / waveforms.rate, gaps=waveforms.gaps, per_turn=keyphasor.pulses_per_revolution, where=where
    )


def _edges(waveforms: Waveforms, keyphasor: Keyphasor, levels: Levels, *, where: str) -> NDArray[np.float64]:
    """Return the edges (edge,) of the whole recording, in fractional samples."""
    finder = EdgeFinder(edge=keyphasor.edge, band=_band(keyphasor, levels, where=where))
    edges = [np.empty(0)]
    for first, volts in waveforms.keyphasor_pieces():
        middle = levels.middle(first, len(volts)) if keyphasor.threshold is None else keyphasor.threshold
        edges.append(finder.take(first, volts, threshold=middle))
    return np.concatenate(edges)


def _band(keyphasor: Keyphasor, levels: Levels, *, where: str) -> float:
    """Return the width [V] of the band about the threshold that a pulse has to leave on both sides."""
    low, high = levels.highest_low, levels.lowest_high
    threshold = keyphasor.threshold
    if threshold is None:
        room = float(np.min(levels.high - levels.low)) / 2
    elif low < threshold < high:
        room = min(threshold - low, high - threshold)
    else:
        raise DataError(
            f"{where}: keyphasor.threshold is {threshold:g} V, want it between the levels of {low:.2f} and {high:.2f} V"
        )
    if keyphasor.hysteresis is None:
        return 2 * HYSTERESIS * room
    if keyphasor.hysteresis >= 2 * room:
        raise DataError(
            f"{where}: keyphasor.hysteresis is {keyphasor.hysteresis:g} V, want less than {2 * room:.2f} V, twice what "
            "lies between the threshold and the nearer level of the pulses"
        )
    return keyphasor.hysteresis
