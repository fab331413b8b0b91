"""History of a running sweep, accumulated block by block for the live plots."""

from rotorrig.acquisition import RawRecording
from rotorrig.app.viewer.live.data.curves import SpeedCurves
from rotorrig.app.viewer.live.data.slow_roll import SlowRollSoFar
from rotorrig.app.viewer.live.data.spectra import SpectraSoFar
from rotorrig.app.viewer.live.data.tracker import LiveTracker, Turns
from rotorrig.app.viewer.live.data.waveform import Waveform
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block

STEP = 0.25  # s of a recording taken at a time


class History:
    """Curves over speed, slow roll and full spectra."""

    def __init__(self, rig: RigConfig) -> None:
        self.curves = SpeedCurves()
        self.slow_roll = SlowRollSoFar(rig)
        self.spectra = SpectraSoFar(rig)

    def add(self, turns: Turns, waveform: Waveform | None) -> None:
        """Add turns that have ended, and the waveform of the last ones."""
        self.curves.add(turns)
        self.slow_roll.add(turns, waveform)
        if waveform is not None and len(turns.t):
            self.spectra.add(waveform, direction=self.curves.direction)


def history_of(recording: RawRecording) -> History:
    """Return what a whole recording comes to."""
    tracker, history = LiveTracker(recording.rig, recording.daq), History(recording.rig)
    for block in split_into_steps(recording):
        history.add(tracker.take(block), tracker.waveform())
    return history


def split_into_steps(recording: RawRecording) -> list[Block]:
    """Return a recording in blocks of about STEP, none across a gap."""
    rate = recording.daq.sample_rate
    size = max(1, round(STEP * rate))
    return [
        Block(counts=counts[i : i + size], first_sample=first + i, t_ns=round((first + i) * 1e9 / rate))
        for first, counts in recording.segments()
        for i in range(0, len(counts), size)
    ]
