"""Universal files: by pyuff, by hand as the specification says, and what is wrong with the rest."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import pyuff

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.uff import read_uff
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from tests.acquisition.importers.foreign_files import NAMES, RATE, uff58, uff164, waves
from tests.acquisition.importers.read_back import volts_of

Mapping = Callable[[str], ChannelMapping]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "waves.uff"


def by_hand(path: Path, **changes: object) -> Path:
    path.write_bytes(b"".join(uff58(name, volts, **changes) for name, volts in waves().items()))
    return path


@pytest.mark.parametrize(
    ("form", "within"), [("4E20.12", 1e-6), ("6E13.5", 6e-5), ("<d", 1e-6), (">d", 1e-6), ("<f", 2e-6), (">f", 2e-6)]
)
def test_every_form_of_data_set_58_is_read(rig: RigConfig, path: Path, form: str, within: float) -> None:
    recording = read_uff(by_hand(path, form=form), rig)
    assert recording.daq.sample_rate == RATE
    for name, volts in waves().items():
        np.testing.assert_allclose(volts_of(recording)[name], volts, atol=within)


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("binary", [0, 1])  # writing the second, pyuff leaves the file open
def test_a_file_of_pyuff_is_read(rig: RigConfig, path: Path, binary: int) -> None:
    for name, volts in waves().items():
        sets = pyuff.prepare_58(
            func_type=1, rsp_node=3, rsp_dir=1, ref_node=0, ref_dir=0, data=volts, x=np.arange(len(volts)) / RATE,
            binary=binary, id1=name, abscissa_spacing=1, abscissa_spec_data_type=17, ordinate_spec_data_type=1,
            orddenom_spec_data_type=0, z_axis_spec_data_type=0, ordinate_axis_units_lab="V",
        )  # fmt: skip
        pyuff.UFF(str(path)).write_sets(sets, mode="add")
    recording = read_uff(path, rig)
    assert recording.daq.sample_rate == RATE
    for name, volts in waves().items():
        np.testing.assert_allclose(volts_of(recording)[name], volts, atol=1e-6)


def test_times_written_one_by_one_are_even(rig: RigConfig, path: Path) -> None:
    x = np.arange(200) / RATE
    recording = read_uff(by_hand(path, form="2(E13.5,E20.12)", x=x), rig)
    assert recording.daq.sample_rate == RATE
    np.testing.assert_allclose(volts_of(recording)["2y"], waves()["2y"], atol=1e-6)


@pytest.mark.parametrize(
    ("unit", "ordinate", "factor", "metres"),
    [("um", 8, None, 1e-6), ("mil", 8, None, 25.4e-6), ("NONE", 8, 1000.0, 1e-3), ("NONE", 8, 1.0, 1.0),
     ("in", 8, 1000.0, 0.0254)],
)  # fmt: skip
def test_the_unit_is_the_labels_or_that_of_data_set_164(
    rig: RigConfig, path: Path, unit: str, ordinate: int, factor: float | None, metres: float
) -> None:
    metres_towards = 25e-6 * np.sin(np.arange(200) / 10)
    sets = [uff58(name, metres_towards / metres, unit=unit, ordinate=ordinate) for name in NAMES[1:]]
    path.write_bytes((uff164(factor) if factor else b"") + b"".join([uff58("keyphasor", waves()["keyphasor"]), *sets]))
    volts = volts_of(read_uff(path, rig))["1y"]
    np.testing.assert_allclose((volts + 10.0) / 7874.0, metres_towards, atol=1e-9)


def test_a_mapping_says_what_the_file_does_not(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    sets = [uff58(f"ch{k}", volts * 1e3, unit="NONE") for k, volts in enumerate(waves().values())]
    path.write_bytes(b"".join(sets))
    text = "".join(
        f'[[channels]]\nprobe = "{name}"\nchannel = "ch{k}"\nunit = "1 mV"\n' for k, name in enumerate(NAMES)
    )
    read = volts_of(read_uff(path, rig, mapping(text)))
    np.testing.assert_allclose(read["1x"], waves()["1x"], atol=1e-6)
    with pytest.raises(DataError, match="no data set 'keyphasor', the config wants it; the file has 'ch0', 'ch1'"):
        read_uff(path, rig)


def test_a_unit_that_contradicts_the_file_is_refused_unless_it_is_meant(
    rig: RigConfig, path: Path, mapping: Mapping
) -> None:
    one = '[[channels]]\nprobe = "1x"\nchannel = "1x"\nunit = "1 mV"\n'
    with pytest.raises(DataError, match=r"'1x' is in \[V\] as the file says, but the mapping says a 1 is 1 mV"):
        read_uff(by_hand(path), rig, mapping(one))
    read = volts_of(read_uff(path, rig, mapping(one + "override = true\n")))
    np.testing.assert_allclose(read["1x"], waves()["1x"] / 1e3, atol=1e-6)
    np.testing.assert_allclose(read["1y"], waves()["1y"], atol=1e-6)
    agreeing = one.replace("1 mV", "1000 mV")
    np.testing.assert_allclose(volts_of(read_uff(path, rig, mapping(agreeing)))["1x"], waves()["1x"], atol=1e-6)


def test_units_that_differ_by_little_differ(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    sets = [uff58(name, np.ones(9), unit="um", ordinate=8) for name in NAMES[1:]]
    path.write_bytes(uff58("keyphasor", np.ones(9)) + b"".join(sets))
    with pytest.raises(DataError, match=r"'1x' is in \[um\] as the file says, but the mapping says a 1 is 1.005 um"):
        read_uff(path, rig, mapping('[[channels]]\nprobe = "1x"\nchannel = "1x"\nunit = "1.005 um"\n'))


def test_a_channel_serves_one_probe(rig: RigConfig, path: Path, mapping: Mapping) -> None:
    with pytest.raises(DataError, match="data set '1x' is mapped to '1x' and '1y', want one each"):
        read_uff(by_hand(path), rig, mapping('[[channels]]\nprobe = "1y"\nchannel = "1x"\n'))


def test_what_is_no_time_response_is_left_out(rig: RigConfig, path: Path) -> None:
    by_hand(path)
    path.write_bytes(uff164(1.0) + uff58("1x", np.ones(7), function=4) + path.read_bytes())
    np.testing.assert_allclose(volts_of(read_uff(path, rig))["1x"], waves()["1x"], atol=1e-6)


def replaced(index: int, **changes: object) -> bytes:
    sets = [uff58(name, volts) for name, volts in waves().items()]
    name = NAMES[index]
    sets[index] = uff58(name, waves()[name], **changes)
    return b"".join(sets)


def everywhere(*, points: int | None = None, last: float = 0.0) -> bytes:
    return b"".join(uff58(name, np.append(volts, last), points=points) for name, volts in waves().items())


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", r"is no universal file \(no line with -1"),
        (b"time [s],1x [V]\n0,1\n", "is no universal file"),
        (b"    -1\n    58\n    -1\n", "data set 1: cannot be read"),
        (uff164(1.0), "has no data set 'keyphasor', the config wants it; the file has no data set 58 of a time"),
        (replaced(1, unit="kg"), r"data set '1x' is in \[kg\], want V or a length such as um"),
        (replaced(1, unit="NONE"), r"data set '1x' says no unit, want one in a mapping"),
        (replaced(0, unit="um"), r"data set 'keyphasor' is in \[um\], want V or mV"),
        (replaced(2, points=999), "data set '1y': has 999 samples, but 'keyphasor' has 200 samples"),
        (replaced(2, step=1e-4), "data set '1y': is sampled at 10000 Hz, but 'keyphasor' is sampled at 25600 Hz"),
        (replaced(2, start=1.0), "data set '1y': begins at 1 s, but 'keyphasor' begins at 0 s"),
        (replaced(2, step=0.0), "data set 3: has an abscissa from 0.0 by 0.0"),
        (replaced(2, time_unit="Hz"), r"data set 3: its abscissa is in \[Hz\], want s"),
        (everywhere(points=10**9), "holds 201 values, its heading says 1000000000"),
        (replaced(3) + uff58("2x", waves()["2x"]), "two data sets are named '2x', want one"),
        (everywhere(last=math.nan), "sample 201, data set 'keyphasor': got nan"),
        (replaced(1)[:9000], "is cut short, it ends in the middle of a data set"),
        (replaced(1)[:4], "is no universal file"),
    ],
    ids=lambda v: v[:30] if isinstance(v, str) else "",
)  # fmt: skip
def test_what_cannot_be_used_is_one_sentence(rig: RigConfig, path: Path, data: bytes, said: str) -> None:
    path.write_bytes(data)
    with pytest.raises(DataError, match=said) as caught:
        read_uff(path, rig)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_said(rig: RigConfig, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"none.uff: cannot be read"):
        read_uff(tmp_path / "none.uff", rig)
