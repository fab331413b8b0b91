"""TDMS files: by nptdms's writer, by hand as NI describes them, scaled by their properties."""

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

from rotorrig.acquisition.importers import tdms_limits
from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.tdms import read_tdms
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from tests.acquisition.importers.foreign_files import NAMES, RATE, tdms_daqmx, tdms_segment, waves
from tests.acquisition.importers.read_back import volts_of

Mapping = Callable[[str], ChannelMapping]
TIMED: dict[str, float | str] = {"wf_increment": 1 / RATE, "wf_start_offset": 0.0, "unit_string": "V"}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "waves.tdms"


def by_hand(**changes: dict[str, float | str]) -> bytes:
    """Return a file of one segment; `changes` are other properties of some channels, by name."""
    channels = [(f"/'g'/'{n}'", volts, TIMED | changes.get(f"_{n}", {})) for n, volts in waves().items()]
    return tdms_segment([("/", np.empty(0), {}), ("/'g'", np.empty(0), {}), *channels])


def test_a_file_made_by_hand_is_read(rig: RigConfig, path: Path) -> None:
    path.write_bytes(by_hand())
    recording = read_tdms(path, rig)
    assert recording.daq.sample_rate == RATE
    for name, volts in waves().items():
        np.testing.assert_allclose(volts_of(recording)[name], volts, atol=1e-6)


def test_segments_follow_one_another(rig: RigConfig, path: Path) -> None:
    path.write_bytes(by_hand() * 3)
    read = volts_of(read_tdms(path, rig))
    np.testing.assert_allclose(read["2x"], np.tile(waves()["2x"], 3), atol=1e-6)


def test_a_file_of_nptdms_is_read(rig: RigConfig, path: Path) -> None:
    channels = [ChannelObject("Measured", n, v.astype(np.float32), properties=TIMED) for n, v in waves().items()]
    with TdmsWriter(str(path)) as file:
        file.write_segment([RootObject(properties={"name": "rig"}), GroupObject("Measured"), *channels])
        file.write_segment(channels)
    recording = read_tdms(path, rig)
    assert recording.samples == 400
    np.testing.assert_allclose(volts_of(recording)["1y"], np.tile(waves()["1y"], 2), atol=2e-6)


def test_counts_are_scaled_as_their_properties_say(rig: RigConfig, path: Path) -> None:
    linear = {
        "NI_Number_Of_Scales": 1,
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 1e-3,
        "NI_Scale[0]_Linear_Y_Intercept": -0.5,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
        "NI_Scaling_Status": "unscaled",
    }
    properties = {"wf_increment": 1 / RATE, "wf_start_offset": 0.0, "NI_UnitDescription": "Volts", **linear}
    counts = {name: np.round((volts + 0.5) / 1e-3).astype(np.int16) for name, volts in waves().items()}
    with TdmsWriter(str(path)) as file:
        file.write_segment([ChannelObject("g", n, c, properties=properties) for n, c in counts.items()])
    read = volts_of(read_tdms(path, rig))
    np.testing.assert_allclose(read["1x"], counts["1x"] * 1e-3 - 0.5, atol=1e-6)


def test_a_log_of_daqmx_is_scaled_from_its_counts(rig: RigConfig, path: Path) -> None:
    scale: dict[str, float | str] = {
        "wf_increment": 1 / RATE,
        "wf_start_offset": 0.0,
        "unit_string": "Volts",
        "NI_Number_Of_Scales": 2,
        "NI_Scale[1]_Scale_Type": "Polynomial",
        "NI_Scale[1]_Polynomial_Coefficients_Size": 2,
        "NI_Scale[1]_Polynomial_Coefficients[0]": 0.25,
        "NI_Scale[1]_Polynomial_Coefficients[1]": 5e-4,
        "NI_Scale[1]_Polynomial_Input_Source": 0,
        "NI_Scaling_Status": "unscaled",
    }
    counts = {name: np.round((volts - 0.25) / 5e-4).astype(np.int16) for name, volts in waves().items()}
    path.write_bytes(tdms_daqmx(counts, scale))
    recording = read_tdms(path, rig)
    assert recording.daq.sample_rate == RATE
    for name in NAMES:
        np.testing.assert_allclose(volts_of(recording)[name], 0.25 + counts[name] * 5e-4, atol=1e-6)


def test_a_mapping_chooses_between_groups_and_says_the_rate(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    with TdmsWriter(str(path)) as file:
        for group, factor in (("raw", 2.0), ("filtered", 1.0)):
            file.write_segment([ChannelObject(group, f"AI{k}", v * factor) for k, v in enumerate(waves().values())])
    text = 'rate = "25.6 kHz"\n' + "".join(
        f'[[channels]]\nprobe = "{n}"\nchannel = "filtered/AI{k}"\nunit = "1 V"\n' for k, n in enumerate(NAMES)
    )
    recording = read_tdms(path, rig, mapping(text))
    assert recording.daq.sample_rate == RATE
    np.testing.assert_allclose(volts_of(recording)["2y"], waves()["2y"], atol=1e-6)
    with pytest.raises(DataError, match="two channels are named 'AI0', want one"):
        read_tdms(path, rig, mapping(text.replace("filtered/", "")))
    with pytest.raises(DataError, match="says no sample rate, want one in a mapping"):
        read_tdms(path, rig, mapping(text.replace('rate = "25.6 kHz"', "")))


def test_a_rate_that_contradicts_the_file_is_refused(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    path.write_bytes(by_hand())
    with pytest.raises(DataError, match="says a sample rate of 25600 Hz, the mapping 10000 Hz"):
        read_tdms(path, rig, mapping('rate = "10 kHz"\nchannels = []\n'))


def lengthened(data: bytes, name: str, values: int) -> bytes:
    """Return the file with another number of values written in a channel's index."""
    at = data.index(f"'{name}'".encode()) + len(name) + 2 + 12
    return data[:at] + struct.pack("<Q", values) + data[at + 8 :]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "is empty, want a TDMS file"),
        (b"time [s],1x [V]\n0,1\n" * 9, "is no TDMS file"),
        (b"TDSm\0\0\0", "is cut short in the segment at byte 0"),
        (by_hand()[:-9], r"is cut short: the segment at byte 0 should have \d+ bytes"),
        (by_hand() + b"TDSx" + b"\0" * 40, r"is damaged at byte \d+, where a segment should begin"),
        (lengthened(by_hand(), "2y", 2**40), r"is damaged: /'g'/'2y' has 1099511627776 values in 8000 bytes"),
        (lengthened(by_hand(), "2y", 150), "cannot be read as TDMS|has .* samples, but"),
        (by_hand(_1x={"unit_string": "g"}), r"'1x' is in \[g\], want V or a length"),
        (by_hand(_1x={"wf_increment": 1e-3}), "'1x': is sampled at 1000 Hz, but 'keyphasor' is sampled at 25600 Hz"),
        (by_hand(_1x={"wf_start_offset": 0.5}), "'1x': begins at 0.5 s, but 'keyphasor' begins at 0 s"),
        (by_hand(_1x={"NI_Scale[4000000000]_Scale_Type": "Linear"}), "'1x': has more than 10 scales"),
        (by_hand().replace(b"2x", b"3x"), "has no channel '2x', the config wants it; the file has 'keyphasor', '1x'"),
        (tdms_segment([("/", np.empty(0), {})]), "the file has no channel of numbers"),
    ],
    ids=lambda v: v[:30] if isinstance(v, str) else "",
)
def test_what_cannot_be_used_is_one_sentence(rig: RigConfig, path: Path, data: bytes, said: str) -> None:
    path.write_bytes(data)
    with pytest.raises(DataError, match=said) as caught:
        read_tdms(path, rig)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_a_file_of_too_many_pieces_is_refused_before_it_is_listed(
    rig: RigConfig, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tdms_limits, "MOST_PIECES", 20)
    path.write_bytes(by_hand() * 2)
    with pytest.raises(DataError, match="is in 28 pieces or more, want at most 20; TDMS Defragment"):
        read_tdms(path, rig)
