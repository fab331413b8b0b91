"""The NI-DAQmx driver as far as it goes without National Instruments' library; the rest is for the bench."""

import inspect
import sys

import pytest

from rotorrig.rig import connect
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.devices import NiDaqmx
from rotorrig.rig.errors import ConfigError, LinkLost
from rotorrig.rig.probes.base import DaqCounters
from rotorrig.rig.probes.nidaqmx import daq as nidaqmx_daq
from rotorrig.rig.probes.nidaqmx.daq import NiDaqmxDaq, first_sentence, read_failure

TABLE = {"driver": "nidaqmx", "device": "Dev1", "sample_rate": "10 kHz"}
OVERFLOW = """Onboard device memory overflow. Because of system and/or bus-bandwidth limitations, the driver could not
read data from the device fast enough to keep up with the device throughput.
Reduce the sample rate, or reduce the number of channels.

Task Name: _unnamedTask<0>

Status Code: -200361"""  # as NI's driver words it


@pytest.fixture
def errors() -> object:
    return pytest.importorskip("nidaqmx", reason="the nidaqmx package is not installed here").errors


def daq() -> NiDaqmxDaq:
    return NiDaqmxDaq(NiDaqmx.model_validate(TABLE), channels=5)


def has_library() -> bool:
    package = pytest.importorskip("nidaqmx", reason="the nidaqmx package is not installed here")
    try:
        package.system.System.local().driver_version  # noqa: B018
    except (package.errors.DaqNotFoundError, package.errors.DaqNotSupportedError):
        return False
    return True


def test_without_the_vendors_library_the_remedy_is_one_sentence() -> None:
    if has_library():
        pytest.skip("NI-DAQmx is installed here")
    with pytest.raises(ConfigError) as error:
        daq().open()
    said = str(error.value)
    assert said.startswith(
        "daq.driver: 'nidaqmx' needs NI-DAQmx, National Instruments' driver, beside the Python package"
    )
    assert "want it installed from ni.com" in said
    assert "\n" not in said


def test_without_the_package_the_remedy_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "nidaqmx", None)  # what Python itself does for a module that must not load
    with pytest.raises(ConfigError, match=r"want it installed: pip install 'rotorrig\[nidaqmx\]'$"):
        daq().open()


def test_a_config_chooses_it_and_its_library_is_loaded_when_opened(rk4: RigConfig) -> None:
    chosen = connect.daq(rk4.model_copy(update={"daq": NiDaqmx.model_validate(TABLE)}))
    assert isinstance(chosen, NiDaqmxDaq)


def test_the_verbs_are_safe_before_open() -> None:
    with daq() as closed:
        closed.stop()
        closed.close()
        assert closed.counters == DaqCounters()
        with pytest.raises(LinkLost, match="Dev1: the DAQ is not open"):
            closed.start()
        with pytest.raises(LinkLost, match=r"want start\(\) first"):
            closed.read()


def test_the_codes_are_the_packages_own() -> None:
    codes = pytest.importorskip("nidaqmx.error_codes").DAQmxErrors
    assert codes.SAMPLES_NOT_YET_AVAILABLE.value == nidaqmx_daq.NO_SAMPLES_YET
    assert {codes(c).name for c in nidaqmx_daq.OVERRUNS} == {
        "INPUT_FIFO_OVERFLOW",
        "INPUT_FIFO_OVERFLOW_2",
        "INPUT_FIFO_OVERFLOW_3",
        "ADC_OVERRUN",
        "AI_OVERRUN",
        "SAMPLES_NO_LONGER_AVAILABLE",
        "ACQ_STOPPED_TO_PREVENT_INPUT_BUFFER_OVERWRITE",
        "ACQ_STOPPED_TO_PREVENT_INTERMEDIATE_BUFFER_OVERFLOW",
    }
    assert {codes(c).name for c in nidaqmx_daq.NOT_THERE} == {
        "INVALID_DEVICE_ID",
        "DEV_CANNOT_BE_ACCESSED",
        "RESOURCE_NOT_IN_POOL_ROUTING",
    }
    assert {codes(c).name for c in nidaqmx_daq.IN_USE} == {"PAL_RESOURCE_RESERVED", "DIG_LINES_RESERVED_OR_UNAVAILABLE"}


@pytest.mark.parametrize("terminals", ["default", "rse", "nrse", "diff", "pseudo-diff"])
def test_every_terminal_configuration_is_known_to_the_package(terminals: str) -> None:
    known = pytest.importorskip("nidaqmx.constants").TerminalConfiguration
    assert NiDaqmx.model_validate(TABLE | {"terminals": terminals}).terminals == terminals
    assert nidaqmx_daq.terminal_name(terminals) in known.__members__


def test_an_overflow_on_the_device_says_what_was_lost_and_what_helps(errors: object) -> None:
    error = errors.DaqReadError(OVERFLOW, -200361, "")  # type: ignore[attr-defined]
    assert read_failure("Dev1", error, timeout=1.0) == (
        "Dev1: the device's own memory ran over and samples were lost, which ended the acquisition (-200361); "
        "want a lower sample rate, fewer channels or a faster bus"
    )


def test_silence_and_a_device_that_is_gone_are_told_apart(errors: object) -> None:
    silent = errors.DaqError("Some or all of the samples requested have not yet been acquired.", -200284)  # type: ignore[attr-defined]
    assert read_failure("Dev1", silent, timeout=0.5) == "Dev1: no samples from the DAQ for 0.5 s"
    gone = errors.DaqError("Device cannot be accessed.  Possible causes:\n\nDevice is no longer present.", -201003)  # type: ignore[attr-defined]
    assert read_failure("Dev1", gone, timeout=0.5) == "Dev1: the DAQ is gone (Device cannot be accessed; -201003)"


def test_nis_texts_are_cut_to_their_first_sentence() -> None:
    assert first_sentence(ValueError(OVERFLOW)) == "Onboard device memory overflow"
    assert first_sentence(ValueError()) == "ValueError"


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"low": "5 V", "high": "-5 V"}, "got low 5 V and high -5 V, want low < high"),
        ({"terminals": "single"}, "'default', 'rse', 'nrse', 'diff' or 'pseudo-diff'"),
        ({"device": "Dev1/ai0"}, "got 'Dev1/ai0', want the device alone, such as Dev1"),
    ],
)
def test_a_wrong_table_is_refused(changed: dict[str, str], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        NiDaqmx.model_validate(TABLE | changed)


def test_the_package_has_every_attribute_the_driver_uses() -> None:
    """What cannot be run without NI's library can at least be spelt right."""
    package = pytest.importorskip("nidaqmx", reason="the nidaqmx package is not installed here")
    task = pytest.importorskip("nidaqmx.task")
    channels = pytest.importorskip("nidaqmx.task.channels")
    collections = pytest.importorskip("nidaqmx.task.collections")
    readers = pytest.importorskip("nidaqmx.stream_readers")
    used = {
        package.Task: ("ai_channels", "timing", "in_stream", "devices", "start", "stop", "close"),
        collections.AIChannelCollection: ("add_ai_voltage_chan", "__iter__"),
        channels.AIChannel: ("ai_dev_scaling_coeff", "ai_rng_low", "ai_rng_high"),
        task.Timing: ("cfg_samp_clk_timing", "samp_clk_rate", "ai_conv_rate"),
        task.InStream: ("input_buf_size",),
        package.system.Device: ("product_type", "serial_num", "ai_simultaneous_sampling_supported"),
        readers.AnalogUnscaledReader: ("read_int32",),
        package.errors.DaqError: ("error_code",),
    }
    missing = [f"{kind.__name__}.{name}" for kind, names in used.items() for name in names if not hasattr(kind, name)]
    assert missing == []
    wanted = inspect.signature(collections.AIChannelCollection.add_ai_voltage_chan).parameters
    assert {"terminal_config", "min_val", "max_val"} <= set(wanted)
    assert {"sample_mode", "samps_per_chan"} <= set(inspect.signature(task.Timing.cfg_samp_clk_timing).parameters)
    reading = inspect.signature(readers.AnalogUnscaledReader.read_int32).parameters
    assert {"number_of_samples_per_channel", "timeout"} <= set(reading)
