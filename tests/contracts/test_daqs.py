"""What every DAQ driver owes its user, run against what can run here, or on the bench with `--rig`.

The framed stream is sent by the simulated board over a real pseudo-terminal; openDAQ's reference device comes with
its SDK.
"""

import importlib.util
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig import connect
from rotorrig.rig.config.description import load, parse
from rotorrig.rig.errors import LinkLost, RigError
from rotorrig.rig.probes.base import Block, Daq, DaqInfo
from rotorrig.rig.probes.calibration import ProbeScale
from rotorrig.sims.wire.launch import simulated_bench
from tests.contracts.stands import Stand, config

NOTICED = 2.0  # s of wall time for a driver to know that its link is lost
OPENDAQ = """
[[probes]]
name = "1x"
position = "250.5 mm"
angle = "0 deg"
channel = 0

[keyphasor]
channel = 1 # the reference device has two

[daq]
driver = "opendaq"
connection = "daqref://device0"
sample_rate = "10 kHz"

"""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    real = metafunc.config.getoption("--rig")
    metafunc.parametrize("stand", [real] if real else ["stream", "opendaq"], indirect=True, scope="module")


@pytest.fixture(scope="module")
def stand(request: pytest.FixtureRequest) -> Iterator[Stand]:
    text = config("serial-line")
    if request.param == "stream":
        with simulated_bench(text, seed=5) as ports:
            yield Stand(parse(text, where="stream"), ports)
    elif request.param != "opendaq":
        yield Stand(load(Path(request.param)), None)
    else:
        if importlib.util.find_spec("opendaq") is None:
            pytest.skip("openDAQ is not installed, want rotorrig[opendaq]")
        before, after = text[: text.index("[[probes]]")], text[text.index("[limits]") :]
        yield Stand(parse(before + OPENDAQ + after, where="opendaq"), None)


@pytest.fixture
def daq(stand: Stand) -> Iterator[Daq]:
    with stand.daq() as daq:
        yield daq


def blocks(daq: Daq, info: DaqInfo, *, seconds: float) -> list[Block]:
    """Read so many seconds of the sample clock."""
    read = [daq.read(timeout=5)]
    while read[-1].first_sample < seconds * info.sample_rate:
        read.append(daq.read(timeout=5))
    return read


def samples_until_lost(daq: Daq) -> int:
    """Read on until the link is known to be lost; return how many samples came."""
    began, count = time.monotonic(), 0
    with pytest.raises(LinkLost) as caught:
        while time.monotonic() < began + 10:
            count += len(daq.read(timeout=1.0).counts)
    assert "\n" not in str(caught.value)
    return count


def test_it_is_the_daq_the_config_describes(stand: Stand, daq: Daq) -> None:
    info = daq.open()
    assert stand.rig.daq
    assert info.model
    assert info.sample_rate == pytest.approx(stand.rig.daq.sample_rate, rel=1e-6)
    used = {probe.channel for probe in stand.rig.probes}
    assert info.channels == len(info.volts_per_count) > max(used)
    assert info.full_scale_counts > 0


def test_the_stream_is_whole_and_in_time(daq: Daq) -> None:
    info = daq.open()
    daq.start()
    samples = 0
    for block in blocks(daq, info, seconds=2.0):
        assert block.first_sample == samples
        assert block.t_ns == round(samples * 1e9 / info.sample_rate)
        assert block.counts.dtype == np.int32
        assert block.counts.shape[1] == info.channels
        assert not block.overrun
        samples += len(block.counts)
    counters = daq.counters
    assert counters.samples == samples
    assert (counters.gaps, counters.lost_samples, counters.overruns, counters.damaged_frames) == (0, 0, 0, 0)


def test_a_stream_may_be_stopped_and_started_again(daq: Daq) -> None:
    daq.open()
    for _ in range(2):
        daq.start()
        assert daq.read(timeout=5).first_sample == 0
        assert daq.read(timeout=5).first_sample > 0
        daq.stop()
        daq.stop()


def test_reading_before_the_start_and_after_the_stop_is_an_error_in_one_sentence(daq: Daq) -> None:
    daq.open()
    with pytest.raises(LinkLost, match="not streaming"):
        daq.read()
    daq.start()
    daq.read(timeout=5)
    daq.stop()
    with pytest.raises(LinkLost, match="not streaming"):
        daq.read()


def test_closing_twice_is_closing_and_a_closed_one_may_be_opened_again(stand: Stand) -> None:
    daq = stand.daq()
    daq.open()
    daq.start()
    daq.read(timeout=5)
    daq.close()
    daq.close()
    with daq:
        daq.open()
        daq.start()
        assert daq.read(timeout=5).first_sample == 0


def test_the_probes_of_a_rotor_at_rest_see_little(stand: Stand, daq: Daq) -> None:
    if stand.ports is None:
        pytest.skip("no simulated rotor: what its probes see at rest is not known")
    info = daq.open()
    daq.start()
    counts = np.concatenate([b.counts for b in blocks(daq, info, seconds=1.5)[-25:]])
    metres = ProbeScale.of(stand.rig, info).displacement(counts)
    assert np.all(np.abs(metres.mean(axis=0)) < 400e-6)  # sag, run-out and gap setting
    assert np.all(np.ptp(metres, axis=0) < 20e-6)


def test_an_open_port_is_refused_to_a_second_user(stand: Stand, daq: Daq) -> None:
    if stand.ports is None:
        pytest.skip("whether a second user is refused is the device's choice")
    daq.open()
    with stand.daq() as second, pytest.raises(LinkLost, match="in use by another program"):
        second.open()


@pytest.mark.parametrize("kind", ["silent", "disconnect"])
def test_a_lost_link_is_known_at_once_and_opened_again_when_it_is_back(stand: Stand, daq: Daq, kind: str) -> None:
    console = stand.console
    daq.open()
    daq.start()
    daq.read(timeout=5)
    lost = console.play([{"kind": kind, "on": "daq"}])["wall"]
    samples_until_lost(daq)
    assert time.monotonic() - lost < NOTICED
    console.play([], calm=True)
    daq.open()
    daq.start()
    assert daq.read(timeout=5).first_sample == 0


def test_another_device_at_the_port_is_no_daq(stand: Stand, daq: Daq) -> None:
    stand.console.play([{"kind": "wrong-device", "on": "daq"}])
    with pytest.raises(RigError) as caught:
        daq.open()
    assert "\n" not in str(caught.value)
    stand.console.play([], calm=True)
    daq.open()


@pytest.mark.parametrize("kind", ["drop", "corrupt", "duplicate"])
def test_disturbed_frames_are_seen_and_counted_and_never_filled_in(stand: Stand, daq: Daq, kind: str) -> None:
    info = daq.open()
    daq.start()
    read = [daq.read(timeout=5)]
    stand.console.play([{"kind": kind, "on": "daq", "direction": "from-device", "count": 3}])
    read += blocks(daq, info, seconds=daq.counters.samples / info.sample_rate + 3.0)
    daq.stop()
    missing = sum(b.first_sample - a.first_sample - len(a.counts) for a, b in pairwise(read))
    counters = daq.counters
    assert counters.lost_samples == missing == (0 if kind == "duplicate" else 3 * len(read[0].counts))
    assert (counters.lost_frames, counters.repeated_frames) == ((0, 3) if kind == "duplicate" else (3, 0))
    assert not any(block.overrun for block in read)


def test_an_overrun_of_the_device_is_seen_and_counted(stand: Stand, daq: Daq) -> None:
    console = stand.console
    info = daq.open()
    daq.start()
    daq.read(timeout=5)
    began = console.play([{"kind": "daq-overrun", "lasts": 0.5}])["wall"]
    read = blocks(daq, info, seconds=daq.counters.samples / info.sample_rate + 4.0)
    lost = console.wait_for(lambda line: "scans" in line and line["wall"] > began, timeout=5)["scans"]
    assert daq.counters.lost_samples == lost == pytest.approx(0.5 * info.sample_rate, rel=0.1)
    assert [block.overrun for block in read].count(True) == daq.counters.overruns == 1


@pytest.mark.campaign
def test_a_motor_driver_at_the_port_of_the_daq_says_so(stand: Stand) -> None:
    if stand.ports is None:
        pytest.skip("the ports of a simulated rig alone can be mistaken")
    with connect.motor(stand.rig, at=stand.ports.daq) as motor, pytest.raises(RigError):
        motor.open()
