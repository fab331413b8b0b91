"""The openDAQ driver against the SDK's reference device, which needs no hardware and no network."""

import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import psutil
import pytest

from rotorrig.rig import connect
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.devices import OpenDaq
from rotorrig.rig.errors import ConfigError, LinkLost
from rotorrig.rig.probes.opendaq.daq import OpenDaqDaq

RATE = 10_000.0
AMPLITUDE, FREQUENCY = 4.0, 25.0  # V, Hz of the reference device's sine


def table(**changed: object) -> OpenDaq:
    return OpenDaq.model_validate(
        {
            "driver": "opendaq",
            "connection": "daqref://device0",
            "sample_rate": "10 kHz",
            "device_settings": {"NumberOfChannels": 3},
            "channel_settings": {"ClientSideScaling": True, "Amplitude": AMPLITUDE, "Frequency": FREQUENCY},
        }
        | changed
    )


@pytest.fixture(autouse=True)
def sdk() -> None:
    pytest.importorskip("opendaq", reason="the openDAQ SDK is not installed here")


@pytest.fixture
def daq() -> Iterator[OpenDaqDaq]:
    with OpenDaqDaq(table(), channels=3) as daq:
        yield daq


def streamed(daq: OpenDaqDaq, seconds: float) -> np.ndarray:
    """Return volts (sample, channel) of so many seconds without a gap."""
    info = daq.open()
    daq.start()
    parts: list[np.ndarray] = []
    while sum(map(len, parts)) < seconds * RATE:
        block = daq.read()
        assert block.first_sample == sum(map(len, parts))
        assert block.t_ns == round(block.first_sample * 1e9 / RATE)
        assert block.counts.dtype == np.int32
        parts.append(block.counts)
    return np.concatenate(parts) * np.array(info.volts_per_count)


def assert_sine(volts: np.ndarray, *, within: float) -> None:
    """See that each channel is one unbroken sine: a lost sample would turn its phase by 0.9 degrees."""
    t = np.arange(len(volts)) / RATE
    base = np.stack([np.cos(2 * np.pi * FREQUENCY * t), np.sin(2 * np.pi * FREQUENCY * t)], axis=1)
    fit, *_ = np.linalg.lstsq(base, volts, rcond=None)
    np.testing.assert_allclose(np.hypot(*fit), AMPLITUDE, rtol=1e-5)
    assert np.abs(volts - base @ fit).max() < within


def test_the_device_says_what_it_is(daq: OpenDaqDaq) -> None:
    info = daq.open()
    assert (info.model, info.serial) == ("openDAQ Reference device", "DevSer0")
    assert (info.sample_rate, info.channels, info.full_scale_counts) == (RATE, 3, 2**23)
    assert info.volts_per_count == (20 / 2**24,) * 3
    assert info.remarks == ("channels 0, 1, 2: raw counts of 1.192 uV",)


def test_raw_counts_come_whole_and_in_time(daq: OpenDaqDaq) -> None:
    assert_sine(streamed(daq, 0.5), within=2e-6)
    counted = daq.counters
    assert counted.samples >= 0.5 * RATE
    assert (counted.gaps, counted.lost_samples, counted.saturated) == (0, 0, (0, 0, 0))


def test_volts_are_rounded_where_the_device_gives_no_counts() -> None:
    settings = {"ClientSideScaling": False, "Amplitude": AMPLITUDE, "Frequency": FREQUENCY}
    with OpenDaqDaq(table(channel_settings=settings), channels=2) as daq:
        assert_sine(streamed(daq, 0.3), within=2e-6)
        info = daq.open()
    assert info.remarks[0].startswith("channels 0, 1: the device gives volts, not counts")


def test_an_input_beyond_its_range_is_counted() -> None:
    settings = {"ClientSideScaling": False, "Amplitude": 10.0, "Frequency": 200.0, "DC": 5.0}
    with OpenDaqDaq(table(channel_settings=settings), channels=2) as daq:
        volts = streamed(daq, 0.3)
        saturated = daq.counters.saturated
    clipped = np.count_nonzero(volts >= 10.0 - 2e-6, axis=0)
    assert 0.2 * len(volts) < clipped[0] < 0.45 * len(volts)  # a sine is above half its amplitude a third of the time
    assert saturated == tuple(clipped)


def test_a_stream_may_be_stopped_and_started_again(daq: OpenDaqDaq) -> None:
    daq.open()
    for _ in range(2):
        daq.start()
        assert daq.read().first_sample == 0
        assert daq.read().first_sample > 0
        daq.stop()
        daq.stop()
    with pytest.raises(LinkLost, match=r"not streaming, want start\(\) first"):
        daq.read()


def test_closing_twice_is_closing_and_opening_again_works(daq: OpenDaqDaq) -> None:
    daq.open()
    daq.close()
    daq.close()
    with pytest.raises(LinkLost, match="the DAQ is not open"):
        daq.start()
    daq.open()
    daq.start()
    assert daq.read().first_sample == 0


def test_a_device_set_by_someone_else_while_it_streams_is_a_lost_link(daq: OpenDaqDaq) -> None:
    daq.open()
    daq.start()
    daq.read()
    assert daq._device is not None
    daq._device._device.set_property_value("GlobalSampleRate", 5000.0)
    with pytest.raises(LinkLost, match="was given another rate or range while it streams"):
        while True:
            daq.read()


def refusal(daq: OpenDaqDaq) -> str:
    with pytest.raises((LinkLost, ConfigError)) as error:
        daq.open()
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize(
    ("changed", "channels", "said"),
    [
        ({"sample_rate": "10240 Hz"}, 3, "daq.sample_rate: got 10240 Hz in the config, want 10204.08163 Hz"),
        ({}, 4, "channel 3: is named in the config, but the DAQ 'openDAQ Reference device' at daqref://device0 has 3"),
        ({"connection": "bogus://7"}, 3, "daq.connection: got 'bogus://7', want one of daq.lt, daq.nd"),
        ({"connection": "daqref://nothing"}, 3, "daqref://nothing: no openDAQ device answers there"),
        (
            {"device_settings": {"Channels": 3}},
            3,
            "daq.device_settings.Channels: 'RefDev0' has no such property, want one of AcquisitionLoopTime,",
        ),
        (
            {"channel_settings": {"Amplitude": "much"}},
            2,
            "daq.channel_settings.Amplitude: 'RefCh0' does not take 'much'",
        ),
    ],
)
def test_what_the_device_is_not_is_said_in_one_sentence(changed: dict[str, object], channels: int, said: str) -> None:
    assert said in refusal(OpenDaqDaq(table(**changed), channels=channels))


@pytest.mark.parametrize("connection", ["device0", "://x", "daqref://"])
def test_a_connection_string_without_a_protocol_is_refused_when_the_config_is_read(connection: str) -> None:
    with pytest.raises(ValueError, match=f"got '{connection}', want a connection string such as daq.nd://"):
        table(connection=connection)


def test_without_the_sdk_the_remedy_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "opendaq", None)  # what Python itself does for a module that must not load
    said = refusal(OpenDaqDaq(table(), channels=3))
    assert said.startswith("daq.driver: 'opendaq' needs the openDAQ SDK, which does not load (")
    assert said.endswith("want it installed: pip install 'rotorrig[opendaq]'")


def test_a_device_of_this_machine_opens_no_socket(daq: OpenDaqDaq) -> None:
    me, seen, done = psutil.Process(), set(), threading.Event()
    before = {c.laddr for c in me.net_connections()}

    def watch() -> None:
        while not done.is_set():
            seen.update(c.laddr for c in me.net_connections())
            time.sleep(0.005)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        streamed(daq, 0.3)
    finally:
        done.set()
        watcher.join()
    assert seen <= before


def test_a_config_chooses_it(rk4: RigConfig) -> None:
    rig = rk4.model_copy(update={"daq": table(device_settings={"NumberOfChannels": 5})})
    with connect.daq(rig) as daq:
        assert daq.open().channels == 5
