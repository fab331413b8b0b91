"""`rotor replay`: play a recording as a live DAQ, into the live view or the order tracking."""

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from rotorrig.acquisition import Event, MotorSample, RawRecording, ReplayDaq, trim_before
from rotorrig.acquisition.files import read_recording
from rotorrig.app.terminal import progress_bars
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.rig import ConfigError
from rotorrig.rig.probes import Block

if TYPE_CHECKING:
    from rotorrig.app.viewer import LiveView


def play(
    path: Path,
    *,
    rate: str,
    view: bool,
    unit: AmplitudeUnit = AS_STATED,
    track: Path | None = None,
    begin: float = 0.0,
) -> float:
    """Play `path` from `begin` [s of its clock] and return the length played [s]; a `view` tells amplitudes in `unit`.

    With `track`, its orders are tracked into that response file: identical bytes at any rate and, played from the
    beginning, those of `rotor track`. Raises DataError, ConfigError.
    """
    pace = _pace(rate)
    recording = read_recording(path)
    if begin:
        recording = trim_before(recording, begin)
    with ExitStack() as stack:
        live = stack.enter_context(_live_view(recording, unit)) if view else None
        played = _play_through(recording, pace, live)
        if track is not None:
            _track(played, track)
    if live:
        live.sink.linger()
    return played.samples / played.daq.sample_rate


def _pace(rate: str) -> float | Literal["max"]:
    if rate == "max":
        return "max"
    try:
        pace = float(rate)
    except ValueError as error:
        raise ConfigError(f"--rate: got '{rate}', want 'max' or a number such as 1.0") from error
    if not pace > 0:
        raise ConfigError(f"--rate: got '{rate}', want 'max' or a number above 0")
    return pace


def _live_view(recording: RawRecording, unit: AmplitudeUnit) -> "LiveView":
    from rotorrig.app.viewer import LiveView, serve  # Rerun takes a second to import

    return LiveView(recording.rig, recording.daq, serve(), events=recording.events, unit=unit)


def _play_through(recording: RawRecording, pace: float | Literal["max"], live: "LiveView | None") -> RawRecording:
    """Play a recording and return the blocks and events received, as a recording."""
    blocks: list[Block] = []
    notes: list[Event | MotorSample] = []
    with progress_bars() as bars, ReplayDaq(recording, rate=pace) as daq:
        task = bars.add_task(
            "replaying", total=recording.samples, note="", unit="x real time", scale=1 / recording.daq.sample_rate
        )
        info = daq.open()
        daq.start()
        while not daq.ended:
            blocks.append(block := daq.read(timeout=float("inf")))
            notes += daq.notes()
            bars.advance(task, len(block.counts))
            if live:
                live.show(block)
    return replace(
        recording,
        daq=info,
        blocks=tuple(blocks),
        events=tuple(note for note in notes if isinstance(note, Event)),
        motor=tuple(note for note in notes if isinstance(note, MotorSample)),
    )


def _track(recording: RawRecording, out: Path) -> None:
    from rotorrig.processing import track
    from rotorrig.processing.files import write_response

    write_response(out, track(recording))
