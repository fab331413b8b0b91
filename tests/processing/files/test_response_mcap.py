"""`response.mcap`: exact for this program, readable by the official MCAP reader, a sentence for any other file."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader

from rotorrig.processing.files.response_mcap import read_response, write_response
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.rig.provenance import Provenance

DOCS = Path(__file__).parents[3] / "docs" / "response-file.md"
ROWS, PROBES, ORDERS = 30, 4, (0.0, 0.5, 1.0)


@pytest.fixture
def response(rk4: RigConfig, rng: np.random.Generator) -> OrderTrackedResponse:
    z = 1e-5 * (rng.standard_normal((ROWS, PROBES, 3)) + 1j * rng.standard_normal((ROWS, PROBES, 3)))
    z[7] = np.nan
    usable = np.ones((ROWS, PROBES), dtype=bool)
    usable[7] = False
    half = rng.standard_normal((ROWS, 3, 8, 8)) * 1e-8
    return OrderTrackedResponse(
        rig=rk4,
        probes=tuple(p.name for p in rk4.probes),
        orders=ORDERS,
        runs=(Run(name="up", direction=1, trial_unbalance={"disk": 0.1 + 0.2j}), Run(name="down", direction=-1)),
        run=np.repeat([0, 1], ROWS // 2).astype(np.intp),
        t=np.linspace(1.0, 30.0, ROWS),
        omega=np.linspace(50.0, 300.0, ROWS),
        alpha=np.full(ROWS, np.pi),
        revolutions=np.full(ROWS, 8.0),
        window="hann",
        z=z,
        covariance=half @ half.transpose(0, 1, 3, 2),
        slow_roll=z[0] / 10,
        slow_roll_covariance=half[0] @ half[0].transpose(0, 2, 1),
        slow_roll_omega=25.1,
        usable=usable,
        reasons=tuple(("gap in the samples",) if i == 7 else () for i in range(ROWS)),
        keyphasor_t=np.arange(300) / 9.7,
        source=Provenance(config_hash=rk4.hash, code_version="0.1.0", source="run.mcap", source_hash="ab" * 8),
        method="resampling",
        omega_sigma=np.full(ROWS, 0.01),
        alpha_sigma=np.full(ROWS, 0.02),
        jitter=np.full(ROWS, 1e-6),
        remarks=tuple(("missed pulse, bridged",) if i == 3 else () for i in range(ROWS)),
        slow_roll_remarks=("the speed varies by 3.0% during the slow roll, want less than 2%",),
        slow_roll_waveform=rng.standard_normal((PROBES, 64)) * 1e-6,
    )


def messages(path: Path) -> list[tuple[str, int, object]]:
    """Return topic, log time and message of everything in a file, by the file's own descriptors alone."""
    found = []
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None and schema.encoding == "protobuf"
            files = descriptor_pb2.FileDescriptorSet.FromString(schema.data)
            pool = descriptor_pool.DescriptorPool()
            for descriptor in files.file:
                pool.Add(descriptor)
            kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
            found.append((channel.topic, message.log_time, kind.FromString(message.data)))
    return found


def test_what_is_read_is_what_was_written_bit_by_bit(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "r.mcap", response)
    found = read_response(tmp_path / "r.mcap")
    for field in dataclasses.fields(response):
        wanted, got = getattr(response, field.name), getattr(found, field.name)
        if isinstance(wanted, np.ndarray):
            assert (got.dtype, got.shape, got.tobytes()) == (wanted.dtype, wanted.shape, wanted.tobytes()), field.name
        else:
            assert got == wanted or (got != got and wanted != wanted), field.name  # NaN
    assert found.rig.text == response.rig.text


def test_arrays_larger_than_a_message_come_in_pieces(
    tmp_path: Path, response: OrderTrackedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rotorrig.processing.files.response_mcap.PIECE", 1000)
    write_response(tmp_path / "r.mcap", response)
    np.testing.assert_array_equal(read_response(tmp_path / "r.mcap").covariance, response.covariance)


def test_the_official_reader_finds_a_bode_table_per_probe_and_order(
    tmp_path: Path, response: OrderTrackedResponse
) -> None:
    write_response(tmp_path / "r.mcap", response)
    rows = [(t, m) for topic, t, m in messages(tmp_path / "r.mcap") if topic == "/bode/1y/1X"]
    assert len(rows) == ROWS
    t, vector = rows[4]
    z, slow = response.z[4, 1, 2], response.slow_roll[1, 2]
    assert t == round(response.t[4] * 1e9)
    assert vector.speed_rpm == round(response.omega[4] * 30 / np.pi)
    assert vector.amplitude_um == pytest.approx(abs(z) * 1e6)
    assert vector.phase_lag_deg == pytest.approx(np.degrees(-np.angle(z)) % 360)
    assert vector.compensated_amplitude_um == pytest.approx(abs(z - slow) * 1e6)
    assert vector.sigma_um == pytest.approx(np.sqrt(np.mean(np.diag(response.covariance[4, 2])[2:4])) * 1e6)
    assert (vector.run, vector.usable, vector.reasons) == ("up", True, "")
    assert (rows[7][1].usable, rows[7][1].reasons) == (False, "gap in the samples")


def test_the_reader_in_the_docs_works(
    tmp_path: Path, response: OrderTrackedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_response(tmp_path / "response.mcap", response)
    monkeypatch.chdir(tmp_path)
    code = DOCS.read_text().split("```python\n")[1].split("```")[0]
    names: dict[str, list[tuple[float, float, float]]] = {}
    exec(code, names)
    speed, amplitude, _ = np.array(names["bode"]).T
    np.testing.assert_allclose(speed, response.omega * 30 / np.pi)
    np.testing.assert_allclose(amplitude, np.abs(response.z[:, 0, 2]) * 1e6)


def test_the_gap_is_a_topic_of_its_own(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "r.mcap", response)
    topics = {topic for topic, _, _ in messages(tmp_path / "r.mcap")}
    assert {"/gap/2x", "/bode/2x/0.5X", "/bode/2x/1X", "/response", "/response/array"} <= topics
    gap = next(m for topic, _, m in messages(tmp_path / "r.mcap") if topic == "/gap/2x")
    assert gap.gap_um == pytest.approx(response.z[0, 2, 0].real * 1e6)


def test_what_a_viewer_plots_first_is_amplitude_and_phase(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "r.mcap", response)
    vector = next(m for topic, _, m in messages(tmp_path / "r.mcap") if topic == "/bode/1x/1X")
    doubles = [field.name for field in vector.DESCRIPTOR.fields if field.type == field.TYPE_DOUBLE]
    names = ["amplitude_um", "phase_lag_deg"]
    assert doubles[:4] == [*names, *(f"compensated_{name}" for name in names)]  # Rerun 0.41 plots four doubles


def test_rows_of_unknown_time_are_told_apart_by_their_number(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "r.mcap", dataclasses.replace(response, t=np.full(ROWS, np.nan)))
    times = [t for topic, t, _ in messages(tmp_path / "r.mcap") if topic == "/bode/1x/1X"]
    assert times == [i * 1_000_000_000 for i in range(ROWS)]
    assert np.isnan(read_response(tmp_path / "r.mcap").t).all()


def test_the_same_response_makes_the_same_file(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "a.mcap", response)
    write_response(tmp_path / "b.mcap", response)
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda path: path.unlink(), "is not there"),
        (lambda path: path.write_bytes(b"speed,amplitude\n1,2\n"), "no MCAP file"),
        (lambda path: path.write_bytes(path.read_bytes()[:-2000]), "unfinished"),
    ],
)
def test_another_file_is_refused_in_a_sentence(
    tmp_path: Path, response: OrderTrackedResponse, spoil: Callable[[Path], object], words: str
) -> None:
    path = tmp_path / "r.mcap"
    write_response(path, response)
    spoil(path)
    with pytest.raises(DataError, match=words):
        read_response(path)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"alpha": np.zeros(3)}, r"'alpha' has shape \(3,\), want \(30,\)"),
        ({"slow_roll_covariance": np.zeros((3, 2, 2))}, "'slow_roll_covariance' has shape"),
        ({"reasons": ((),) * (ROWS + 1)}, "do not belong together"),
    ],
)
def test_arrays_that_do_not_belong_together_are_refused(
    tmp_path: Path, response: OrderTrackedResponse, change: dict[str, object], words: str
) -> None:
    write_response(tmp_path / "r.mcap", dataclasses.replace(response, **change))
    with pytest.raises(DataError, match=words):
        read_response(tmp_path / "r.mcap")


def test_numbers_that_no_measurement_has_are_refused(tmp_path: Path, response: OrderTrackedResponse) -> None:
    for changed, said in (
        ({"slow_roll_covariance": -response.slow_roll_covariance}, "'slow_roll_covariance' has a variance below zero"),
        ({"alpha": response.alpha + 1e40}, r"'alpha' has a number beyond 1e\+30"),
    ):
        write_response(tmp_path / "odd.mcap", dataclasses.replace(response, **changed))
        with pytest.raises(DataError, match=said):
            read_response(tmp_path / "odd.mcap")
