"""`rotor replay`: a recording played as a live DAQ, into the live view if wanted."""

from contextlib import ExitStack
from pathlib import Path
from typing import Literal

from rotorrig.acquisition.mcap_file import read_recording
from rotorrig.acquisition.replay import ReplayDaq
from rotorrig.app.console import progress_bars
from rotorrig.rig.errors import ConfigError


def play(path: Path, *, rate: str, view: bool) -> float:
    """Play `path` and return its length [s]. Raises DataError, ConfigError."""
    pace: float | Literal["max"] = "max"
    if rate != "max":
        try:
            pace = float(rate)
        except ValueError as error:
            raise ConfigError(f"--rate: got '{rate}', want 'max' or a number such as 1.0") from error
        if not pace > 0:
            raise ConfigError(f"--rate: got '{rate}', want 'max' or a number above 0")
    recording = read_recording(path)
    with ExitStack() as stack:
        live = None
        if view:
            from rotorrig.app.viewer import LiveView, serve

            live = stack.enter_context(LiveView(recording.rig, recording.daq, serve()))
        bars = stack.enter_context(progress_bars())
        task = bars.add_task("replaying", total=recording.samples, note="")
        daq = stack.enter_context(ReplayDaq(recording, rate=pace))
        daq.open()
        daq.start()
        for _ in recording.blocks:
            block = daq.read()
            bars.advance(task, len(block.counts))
            if live:
                live.show(block)
    if live:
        live.sink.linger()
    return recording.samples / recording.daq.sample_rate
