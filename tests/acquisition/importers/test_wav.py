"""WAV files: by the standard library, by hand as the specification says, calibrated by a mapping."""

import struct
import wave
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.wav import read_wav
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError, DataError
from tests.acquisition.importers.foreign_files import fmt, pcm, riff, waves
from tests.acquisition.importers.read_back import ALL, volts_of

Mapping = Callable[[str], ChannelMapping]
FULL_SCALE = 20.0  # V
TEN_VOLTS = ALL.format(unit="20 V")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "waves.wav"


def scans(bits: int) -> np.ndarray:
    """Return the waves as counts (scan, channel) of a converter of +-20 V."""
    return np.round(np.column_stack(list(waves().values())) / FULL_SCALE * 2 ** (bits - 1)).astype(np.int64)


@pytest.mark.parametrize("bits", [8, 16, 24, 32])
def test_pcm_keeps_its_counts(rig: RigConfig, path: Path, mapping: Mapping, bits: int) -> None:
    path.write_bytes(
        riff((b"fmt ", fmt(1, channels=5, rate=48_000, bits=bits)), (b"data", pcm(scans(bits), bits=bits)))
    )
    recording = read_wav(path, rig, mapping(TEN_VOLTS))
    assert recording.daq.sample_rate == 48_000
    assert recording.daq.full_scale_counts == 2 ** (bits - 1)
    np.testing.assert_array_equal(recording.blocks[0].counts[:, [4, 0, 1, 2, 3]], scans(bits))
    for name, volts in waves().items():
        np.testing.assert_allclose(volts_of(recording)[name], volts, atol=FULL_SCALE / 2**bits * 1.001)


@pytest.mark.parametrize("width", [4, 8])
def test_floating_point_is_scaled(rig: RigConfig, path: Path, mapping: Mapping, width: int) -> None:
    values = np.column_stack(list(waves().values())) / FULL_SCALE
    data = values.astype(f"<f{width}").tobytes()
    path.write_bytes(riff((b"fmt ", fmt(3, channels=5, rate=25_600, bits=8 * width)), (b"data", data)))
    recording = read_wav(path, rig, mapping(TEN_VOLTS))
    for name, volts in waves().items():
        np.testing.assert_allclose(volts_of(recording)[name], volts, atol=2e-6)
    assert recording.events[0].text.endswith("clipping cannot be seen in a WAV")


def test_a_file_of_the_standard_library_is_read(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    with wave.open(str(path), "wb") as file:
        file.setnchannels(5)
        file.setsampwidth(3)
        file.setframerate(51_200)
        file.writeframes(pcm(scans(24), bits=24))
    recording = read_wav(path, rig, mapping(TEN_VOLTS))
    assert recording.daq.sample_rate == 51_200
    np.testing.assert_array_equal(recording.blocks[0].counts[:, 0], scans(24)[:, 1])


def test_an_extensible_header_and_other_chunks_are_read(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    guid = struct.pack("<H", 1) + bytes.fromhex("000000001000800000aa00389b71")  # KSDATAFORMAT_SUBTYPE_PCM
    header = fmt(0xFFFE, channels=5, rate=25_600, bits=24) + struct.pack("<HHI", 22, 24, 0) + guid
    chunks = ((b"bext", b"odd"), (b"fmt ", header), (b"fact", b"\0" * 4), (b"data", pcm(scans(24), bits=24)))
    path.write_bytes(riff(*chunks))
    recording = read_wav(path, rig, mapping(TEN_VOLTS))
    np.testing.assert_array_equal(recording.blocks[0].counts[:, 0], scans(24)[:, 1])


def test_a_long_file_says_its_size_elsewhere(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    data = pcm(scans(16), bits=16)
    sizes = struct.pack("<QQQI", 0, len(data), len(scans(16)), 0)
    made = riff((b"ds64", sizes), (b"fmt ", fmt(1, channels=5, rate=25_600, bits=16)), (b"data", data), form=b"RF64")
    path.write_bytes(made.replace(b"data" + struct.pack("<I", len(data)), b"data\xff\xff\xff\xff"))
    assert read_wav(path, rig, mapping(TEN_VOLTS)).samples == 200


def test_lengths_are_displacements_about_the_gap_voltage(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    path.write_bytes(riff((b"fmt ", fmt(1, channels=5, rate=25_600, bits=16)), (b"data", pcm(scans(16), bits=16))))
    text = TEN_VOLTS.replace('channel = 2\nunit = "20 V"', 'channel = 2\nunit = "0.5 mm"')
    recording = read_wav(path, rig, mapping(text))
    metres = (volts_of(recording)["1x"] + 10.0) / 7874.0
    np.testing.assert_allclose(metres, scans(16)[:, 1] / 2**15 * 0.5e-3, atol=1e-9)
    assert "1x taken as displacement towards the probe" in recording.events[0].text


def test_a_clipped_input_is_at_the_end_of_its_counts(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    clipped = np.full((10, 5), 32767)
    path.write_bytes(riff((b"fmt ", fmt(1, channels=5, rate=25_600, bits=16)), (b"data", pcm(clipped, bits=16))))
    recording = read_wav(path, rig, mapping(TEN_VOLTS))
    assert (recording.blocks[0].counts == recording.daq.full_scale_counts - 1).all()


FMT16 = (b"fmt ", fmt(1, channels=5, rate=25_600, bits=16))
DATA16 = (b"data", pcm(scans(16), bits=16))


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", r"is no WAV file"),
        (b"RIFF....AVI ", r"is no WAV file"),
        (riff(FMT16, DATA16)[:-5], "is cut short, 1995 of 2000 bytes of samples are there"),
        (riff(FMT16), "ends before its samples"),
        (riff(DATA16, FMT16), "has its samples before the 'fmt ' chunk"),
        (riff((b"fmt ", b"\1\0\5\0"), DATA16), "its 'fmt ' chunk has 4 bytes, want 16"),
        (riff((b"fmt ", fmt(2, channels=5, rate=25_600, bits=16)), DATA16), "is coded as format 2 with 16 bits"),
        (riff((b"fmt ", fmt(1, channels=0, rate=25_600, bits=16)), DATA16), "is coded as format 1 with 16 bits"),
        (riff((b"fmt ", fmt(1, channels=5, rate=0, bits=16)), DATA16), "says a sample rate of 0 Hz"),
        (riff(FMT16, (b"data", b"\0" * 18)), "has 18 bytes of samples, want whole scans of 10 bytes"),
        (riff(FMT16, (b"data", b"\0" * 20)), "has 2 samples, want waveforms"),
        (riff((b"fmt ", fmt(1, channels=2, rate=25_600, bits=16)), DATA16), "2 channels, the mapping wants number 3"),
        (riff((b"fmt ", fmt(3, channels=5, rate=25_600, bits=32)), (b"data", b"\xff" * 100)), "sample 1.*got nan"),
    ],
    ids=lambda v: v[:30] if isinstance(v, str) else "",
)  # fmt: skip
def test_what_cannot_be_used_is_one_sentence(
    rig: RigConfig, path: Path, mapping: Mapping, data: bytes, said: str
) -> None:
    path.write_bytes(data)
    with pytest.raises(DataError, match=said) as caught:
        read_wav(path, rig, mapping(TEN_VOLTS))
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_without_a_mapping_nobody_knows_what_is_what(rig: RigConfig, path: Path) -> None:
    path.write_bytes(riff(FMT16, DATA16))
    with pytest.raises(ConfigError, match="names neither channels nor units, want a mapping"):
        read_wav(path, rig, None)
