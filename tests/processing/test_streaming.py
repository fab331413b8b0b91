"""Tracking from the file: the same response as from memory, in memory that does not grow with the recording."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.files.recording_mcap import RecordingWriter, open_recording, read_recording
from rotorrig.acquisition.recording import Event, RawRecording
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.noise import covariance
from rotorrig.processing.pipeline import track
from rotorrig.processing.settings import Tracking
from rotorrig.rig.probes.base import Block
from tests.processing.synthetic import chirp

RPM = np.pi / 30
RATE = 10_000.0
CYCLE = 6.0  # s up, then as long down
GROWTH_MB = 20.0  # stated: of a recording ten times as long, 43 MB of counts more; 13 measured

PEAK = """
import sys
from pathlib import Path
from rotorrig.acquisition.files.recording_mcap import open_recording
from rotorrig.processing.pipeline import track
with open_recording(Path(sys.argv[1])) as recording:
    track(recording)
print(next(line.split()[1] for line in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in line))
"""


def cycles(record: Callable[..., RawRecording], count: int) -> tuple[RawRecording, Iterator[Block]]:
    """Return a cycle up and down, and its blocks `count` times over: the shaft angle goes on where it left."""
    t = np.arange(int(CYCLE * RATE)) / RATE
    rise = 2 * (2 * np.pi * 120 - 600 * RPM * CYCLE) / CYCLE**2  # 120 whole turns
    up = chirp(t, start=600 * RPM, rate=rise)
    theta = np.concatenate([up, 2 * np.pi * 240 - up[::-1]])
    x = np.tile((20e-6 * np.cos(theta - 0.5))[:, None], 4)
    one = record(theta, x + 0.1e-6 * np.random.default_rng(1).standard_normal(x.shape), rate=RATE)
    counts, size = one.blocks[0].counts, 2_000

    def blocks() -> Iterator[Block]:
        for number in range(count * len(counts) // size):
            first = number * size
            part = counts[first % len(counts) : first % len(counts) + size]
            yield Block(counts=part, first_sample=first, t_ns=round(first * 1e9 / RATE))

    return one, blocks()


def write(path: Path, record: Callable[..., RawRecording], count: int) -> None:
    one, blocks = cycles(record, count)
    with RecordingWriter(path, one.rig, one.daq, one.source) as writer:
        for number in range(2 * count):
            writer.write_event(Event(t_ns=round(number * CYCLE * 1e9), kind="mark", text=("up", "down")[number % 2]))
        for block in blocks:
            writer.write_block(block)


@pytest.fixture(scope="module")
def short(record: Callable[..., RawRecording], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("streaming") / "short.mcap"
    write(path, record, 2)
    return path


@pytest.mark.parametrize("method", ["resampling", "vold-kalman"])
def test_a_response_from_the_file_is_that_from_memory_to_the_last_bit(short: Path, tmp_path: Path, method: str) -> None:
    settings = Tracking(method=method)
    write_response(tmp_path / "memory.mcap", track(read_recording(short), settings))
    with open_recording(short) as recording:
        write_response(tmp_path / "file.mcap", track(recording, settings))
    assert (tmp_path / "file.mcap").read_bytes() == (tmp_path / "memory.mcap").read_bytes()


@pytest.mark.campaign
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="asks Linux how much memory it had at the most")
def test_memory_is_flat_with_the_length_of_the_recording(
    short: Path, record: Callable[..., RawRecording], tmp_path: Path
) -> None:
    write(tmp_path / "long.mcap", record, 20)
    peaks = [
        int(subprocess.run([sys.executable, "-c", PEAK, path], check=True, capture_output=True, text=True).stdout)
        / 1024
        for path in (short, tmp_path / "long.mcap")
    ]
    assert peaks[1] - peaks[0] < GROWTH_MB, peaks


def test_no_more_segments_are_kept_than_the_noise_needs(short: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[int] = []
    average = covariance._average
    monkeypatch.setattr(covariance, "MOST", 20)
    monkeypatch.setattr(
        covariance, "_average", lambda f, spectra, *rest: kept.append(len(spectra)) or average(f, spectra, *rest)
    )
    track(read_recording(short))
    assert set(kept) == {11}  # of 22, every other
