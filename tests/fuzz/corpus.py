"""Small good files of every kind the program reads, for the fuzzer to damage: made here, nothing binary is kept."""

import io
import json
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer
from nptdms import ChannelObject, TdmsWriter

from rotorrig.acquisition.exporters.csv import write_csv
from rotorrig.acquisition.exporters.uff import write_uff
from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.acquisition.recording import Event, MotorSample, RawRecording
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig, load
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance
from tests.acquisition.importers import foreign_files as made

ROOT = Path(__file__).parents[2]
RK4 = load(ROOT / "configs/rk4.toml")
SAMPLES = 40

CHANNELS = "".join(
    f'[[channels]]\nprobe = "{name}"\nchannel = {number}\nunit = "20 V"\n'
    for number, name in enumerate(made.NAMES, start=1)
).encode()
BODE_CSV = b"run,rpm,amp,phase,re,im\n" + b"".join(
    b"%s,%d,%.3f,%.2f,%.3f,%.3f\n" % (run, 1000 + 10 * k, 10 + k, -5.0 * k, 3.0 + k, 4.0 - k)
    for run in (b"a", b"b")
    for k in range(9)
)
BODE_MAPPING = b"""run_column = "run"
delimiter = ","
[speed]
column = "rpm"
unit = "1 rpm"
[[vectors]]
probe = "1x"
amplitude = "amp"
phase = "phase"
unit = "1 um"
amplitude_is = "peak-to-peak"
phase_is = "lag"
phase_unit = "1 deg"
[[vectors]]
probe = "1y"
real = "re"
imaginary = "im"
unit = "1 mil"
[[runs]]
name = "up"
direction = "up"
value = "a"
ramp = "30 rpm/s"
[[runs]]
name = "with mass"
direction = "up"
value = "b"
ramp = "30 rpm/s"
revolutions = 8
trial = [{ disk = "disk", amount = "12 g mm", angle = "90 deg" }]
[slow_roll]
speed = "300 rpm"
vectors = [{ probe = "1x", amplitude = "4 um", phase = "90 deg" }]
[uncertainty]
absolute = "1 um"
relative = 0.1
"""


def recording() -> RawRecording:
    """Return a short recording of the RK4 with a gap, an event and a reading of the motor."""
    counts = np.random.default_rng(3).integers(-2000, 2000, (SAMPLES, 5), dtype=np.int32)
    blocks = (
        Block(counts=counts[:20], first_sample=0, t_ns=0),
        Block(counts=counts[20:], first_sample=30, t_ns=3_000_000, overrun=True),
    )
    daq = DaqInfo(
        model="stream DAQ",
        serial="7",
        sample_rate=1e4,
        channels=5,
        volts_per_count=(6e-4,) * 5,
        full_scale_counts=32768,
    )
    return RawRecording(
        rig=RK4,
        daq=daq,
        blocks=blocks,
        events=(Event(t_ns=0, kind="mark", text="up"),),
        motor=(MotorSample(t_ns=10, speed=50.0, setpoint=50.5, running=True, fault=""),),
        source=Provenance(config_hash=RK4.hash, code_version="0.1.0", source="bench"),
        complete=True,
    )


def response(rig: RigConfig = RK4) -> OrderTrackedResponse:
    """Return three rows of two orders of the RK4."""
    rng = np.random.default_rng(4)
    z = 1e-5 * (rng.standard_normal((3, 4, 2)) + 1j * rng.standard_normal((3, 4, 2)))
    return OrderTrackedResponse(
        rig=rig,
        probes=tuple(probe.name for probe in rig.probes),
        orders=(0.0, 1.0),
        runs=(Run(name="up", direction=1, trial_unbalance={"disk": 1e-6 + 2e-6j}),),
        run=np.zeros(3, dtype=np.intp),
        t=np.arange(3.0),
        omega=100.0 + np.arange(3.0),
        alpha=np.ones(3),
        revolutions=np.full(3, 8.0),
        window="hann",
        z=z,
        covariance=np.tile(1e-16 * np.eye(8), (3, 2, 1, 1)),
        slow_roll=z[0] / 10,
        slow_roll_covariance=np.tile(1e-16 * np.eye(8), (2, 1, 1)),
        slow_roll_omega=30.0,
        usable=np.array([[True] * 4, [False] * 4, [True] * 4]),
        reasons=((), ("1x: clipped",) * 4, ()),
        keyphasor_t=np.arange(10) / 50,
        source=Provenance(config_hash=rig.hash, code_version="0.1.0", source="run.mcap"),
    )


def build(folder: Path) -> dict[str, list[bytes]]:
    """Return the seeds of every kind of input; `folder` is for files that can only be written as such."""

    def written(write: Callable[[Path], object]) -> bytes:
        path = folder / "seed"
        write(path)
        data = path.read_bytes()
        path.unlink()
        return data

    runs = [written(lambda path: write_recording(path, recording(), overwrite=True))]
    responses = [written(lambda path: write_response(path, response()))]
    return {
        "run": [*runs, *map(without_checks, runs)],
        "response": [*responses, *map(without_checks, responses)],
        "csv": [written(lambda path: write_csv(path, _whole())), _foreign_csv()],
        "uff": [
            written(lambda path: write_uff(path, _whole())),
            *_foreign_uff(),
        ],
        "tdms": [_tdms_by_hand(), written(_tdms_by_library), written(_tdms_scaled), _tdms_log()],
        "wav": _wavs(),
        "channels": [CHANNELS, b'rate = "10 kHz"\n[time]\ncolumn = "t"\nunit = "1 ms"\n' + CHANNELS],
        "bode": [BODE_CSV],
        "bode mapping": [BODE_MAPPING],
        "config": [(ROOT / f"configs/{name}.toml").read_bytes() for name in ("rk4", "kfupm-rk4")],
        "daq": [_daq_stream(), _daq_stream()[90:], b"".join(map(_frame, (1, 3, 0x7F), (INFO, b"\0" * 8, b"no")))],
        "daq info": [INFO],
        "line": [b"<02 OK*858B\n", b"<01 OK 1 600000 100000 encoder home-built 1*0000\n", b"<03 ERR limit*0000\r\n"],
    }


def without_checks(data: bytes) -> bytes:
    """Return an MCAP file anew, without compression and without CRCs, so that damage gets as far as the messages."""
    out = io.BytesIO()
    writer = Writer(out, compression=CompressionType.NONE, enable_crcs=False, enable_data_crcs=False)
    writer.start(library="fuzz")
    schemas: dict[int, int] = {}
    channels: dict[int, int] = {}
    for record in StreamReader(io.BytesIO(data)).records:
        match record:
            case Schema() if record.id not in schemas:
                schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
            case Channel() if record.id not in channels:
                schema = schemas[record.schema_id]
                channels[record.id] = writer.register_channel(record.topic, record.message_encoding, schema)
            case Message():
                writer.add_message(channels[record.channel_id], record.log_time, record.data, record.publish_time)
            case Metadata():
                writer.add_metadata(record.name, record.metadata)
            case Attachment():
                writer.add_attachment(0, 0, record.name, record.media_type, record.data)
    writer.finish()
    return out.getvalue()


def _whole() -> RawRecording:
    """Return the recording without its gap."""
    full = recording()
    blocks = (full.blocks[0], Block(counts=full.blocks[1].counts, first_sample=20, t_ns=2_000_000))
    return RawRecording(**{name: getattr(full, name) for name in full.__dataclass_fields__} | {"blocks": blocks})


def _foreign_csv() -> bytes:
    rows = b"".join(b"%.4f;%.3f;%.1f;2.5;-3;1e1;note\n" % (k / 1e3, -2 - k % 5, 10.0 * k) for k in range(12))
    return b"time [ms];keyphasor [V];1x [um];1y [mil];2x [V];2y [um];remark\n" + rows


def _foreign_uff() -> list[bytes]:
    waves = made.waves(12)
    x = np.arange(12) / made.RATE
    forms = ("4E20.12", "6E13.5", "<f", ">d")
    seeds = [b"".join(made.uff58(name, volts, form=form) for name, volts in waves.items()) for form in forms]
    uneven = b"".join(made.uff58(name, v, form="2(E13.5,E20.12)", x=x) for name, v in waves.items())
    lengths = [
        made.uff58(name, 0.1 + 0 * v, unit="NONE", ordinate=8) for name, v in waves.items() if name != "keyphasor"
    ]
    in_mm = made.uff164(1000.0) + made.uff58("keyphasor", waves["keyphasor"]) + b"".join(lengths)
    return [*seeds, uneven, in_mm]


def _tdms_by_hand() -> bytes:
    timed: dict[str, float | str] = {"wf_increment": 1 / made.RATE, "wf_start_offset": 0.0, "unit_string": "V"}
    nothing = np.empty(0)
    waves = [(f"/'g'/'{name}'", volts, timed) for name, volts in made.waves(12).items()]
    return made.tdms_segment([("/", nothing, {}), ("/'g'", nothing, {"note": "x"}), *waves]) * 2


def _tdms_log() -> bytes:
    properties: dict[str, float | str] = {
        "wf_increment": 1e-4,
        "unit_string": "V",
        "NI_Number_Of_Scales": 2,
        "NI_Scale[1]_Scale_Type": "Linear",
        "NI_Scale[1]_Linear_Slope": 1e-3,
        "NI_Scale[1]_Linear_Y_Intercept": 0.0,
        "NI_Scale[1]_Linear_Input_Source": 0,
    }
    return made.tdms_daqmx({name: np.arange(8, dtype=np.int16) for name in made.NAMES}, properties)


def _tdms_by_library(path: Path) -> None:
    timed = {"wf_increment": 1e-4, "unit_string": "V", "wf_start_time": np.datetime64("2026-11-21T12:00:00")}
    with TdmsWriter(str(path)) as file:
        for _ in range(2):
            file.write_segment(
                [ChannelObject("g", n, v.astype(np.float32), properties=timed) for n, v in made.waves(8).items()]
            )


def _tdms_scaled(path: Path) -> None:
    scale = {
        "wf_increment": 1e-4,
        "NI_UnitDescription": "Volts",
        "NI_Number_Of_Scales": 2,
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 1e-3,
        "NI_Scale[0]_Linear_Y_Intercept": -0.5,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
        "NI_Scale[1]_Scale_Type": "Polynomial",
        "NI_Scale[1]_Polynomial_Coefficients_Size": 2,
        "NI_Scale[1]_Polynomial_Coefficients[0]": 0.0,
        "NI_Scale[1]_Polynomial_Coefficients[1]": 1.0,
        "NI_Scale[1]_Polynomial_Input_Source": 0,
        "NI_Scaling_Status": "unscaled",
    }
    with TdmsWriter(str(path)) as file:
        file.write_segment([ChannelObject("g", n, np.arange(8, dtype=np.int16), properties=scale) for n in made.NAMES])


def _wavs() -> list[bytes]:
    scans = np.arange(60).reshape(12, 5)
    seeds = []
    for bits in (8, 16, 24, 32):
        data = made.pcm(scans, bits=bits)
        seeds.append(made.riff((b"fmt ", made.fmt(1, channels=5, rate=25_600, bits=bits)), (b"data", data)))
    floats = (scans / 100).astype("<f4").tobytes()
    seeds.append(
        made.riff((b"fmt ", made.fmt(3, channels=5, rate=25_600, bits=32)), (b"LIST", b"x"), (b"data", floats))
    )
    return seeds


INFO = json.dumps(
    {
        "protocol": 1,
        "model": "m",
        "serial": "s",
        "sample_rate_hz": 1e4,
        "channels": 2,
        "volts_per_count": [1e-3, 1e-3],
        "full_scale_counts": 32768,
    }
).encode()


def _frame(kind: int, payload: bytes) -> bytes:
    """Return a frame of the DAQ stream, docs/daq-stream.md."""
    body = struct.pack("<BBH", kind, 0, len(payload)) + payload
    return b"\xa5\x5a" + body + struct.pack("<I", zlib.crc32(body))


def _daq_stream() -> bytes:
    data = b"".join(_frame(2, struct.pack("<IQHB", n, 4 * n, 4, 2) + bytes(range(24))) for n in range(4))
    return _frame(1, INFO) + data + _frame(3, struct.pack("<Q", 16))
