"""Data of the live view, computed from blocks: tracked vectors, waveforms, slow roll, spectra, sweep history."""

from rotorrig.app.viewer.live.data.curves import WAYS, Points, SpeedCurves
from rotorrig.app.viewer.live.data.history import STEP, History, history_of, split_into_steps
from rotorrig.app.viewer.live.data.slow_roll import SlowRollSoFar
from rotorrig.app.viewer.live.data.spectra import SpectraSoFar
from rotorrig.app.viewer.live.data.tracker import LiveTracker
from rotorrig.app.viewer.live.data.waveform import POINTS, THETA, Waveform

__all__ = [
    "POINTS",
    "STEP",
    "THETA",
    "WAYS",
    "History",
    "LiveTracker",
    "Points",
    "SlowRollSoFar",
    "SpectraSoFar",
    "SpeedCurves",
    "Waveform",
    "history_of",
    "split_into_steps",
]
