"""What viewers read of `response.mcap`: whirl vectors, orbits in place and the log, by the official reader alone."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader
from numpy.typing import NDArray

from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.files.response_scene import FALLING, KEYPHASOR, RISING, exaggeration
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.provenance import Provenance

RAD = np.pi / 30
ROWS = 10
Made = Callable[..., OrderTrackedResponse]


@pytest.fixture
def made(rk4: RigConfig) -> Made:
    """Return a response of which plane 1 sees forward circles of 20 um and plane 2 backward ones of 10 um."""

    def make(**changes: Any) -> OrderTrackedResponse:
        z = np.zeros((ROWS, 4, 2), dtype=complex)
        z[:, 0, 1], z[:, 1, 1] = 20e-6, -20e-6j  # x = r cos(theta), y = r sin(theta)
        z[:, 2, 1], z[:, 3, 1] = 10e-6, 10e-6j
        covariance = np.broadcast_to(1e-14 * np.eye(8), (ROWS, 2, 8, 8))
        response = OrderTrackedResponse(
            rig=rk4,
            probes=("1x", "1y", "2x", "2y"),
            orders=(0.0, 1.0),
            runs=(Run(name="up", direction=1), Run(name="down", direction=-1)),
            run=np.repeat([0, 1], ROWS // 2).astype(np.intp),
            t=np.arange(1.0, ROWS + 1),
            omega=np.concatenate([np.linspace(500, 900, 5), np.linspace(900, 500, 5)]) * RAD,
            alpha=np.zeros(ROWS),
            revolutions=np.full(ROWS, 8.0),
            window="hann",
            z=z,
            covariance=covariance,
            slow_roll=np.full((4, 2), np.nan + 0j),
            slow_roll_covariance=covariance[0],
            slow_roll_omega=np.nan,
            usable=np.ones((ROWS, 4), dtype=bool),
            reasons=((),) * ROWS,
            keyphasor_t=np.empty(0),
            source=Provenance(config_hash=rk4.hash, code_version="0.1.0", source="run.mcap", source_hash="ab" * 8),
        )
        return dataclasses.replace(response, **changes)

    return make


def read(path: Path, *topics: str) -> list[tuple[int, Any]]:
    """Return log time and message of everything on some topics, by the file's own descriptors alone."""
    found = []
    with path.open("rb") as file:
        for schema, _, message in make_reader(file).iter_messages(topics=topics):
            assert schema is not None
            pool = descriptor_pool.DescriptorPool()
            for part in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
                pool.Add(part)
            kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
            found.append((message.log_time, kind.FromString(message.data)))
    return found


def points(cloud: Any) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Return the points (point, 3) and their colours (point, 3) of a foxglove.PointCloud, by its own field table."""
    types = {7: "<f4", 1: "u1"}  # NumericType
    layout = np.dtype(
        {
            "names": [f.name for f in cloud.fields],
            "formats": [types[f.type] for f in cloud.fields],
            "offsets": [f.offset for f in cloud.fields],
            "itemsize": cloud.point_stride,
        }
    )
    read = np.frombuffer(cloud.data, dtype=layout)
    return (
        np.column_stack([read[name].astype(float) for name in "xyz"]),
        np.column_stack([read[name] for name in ("red", "green", "blue")]),
    )


def test_a_circle_is_all_forward_or_all_backward(tmp_path: Path, made: Made) -> None:
    write_response(tmp_path / "r.mcap", made())
    ((_, first), *_) = read(tmp_path / "r.mcap", "/whirl/1x-1y/1X")
    assert (first.forward_um, first.backward_um) == pytest.approx((20.0, 0.0), abs=1e-9)
    assert np.cos(np.radians(first.forward_phase_lag_deg)) == pytest.approx(1.0)  # 0 or 360 degrees
    assert first.forward_sigma_um == pytest.approx(0.1 / np.sqrt(2))  # 0.1 um at each probe, halved sum of two
    assert (first.speed_rpm, first.run, first.usable) == (500, "up", True)
    ((_, first), *_) = read(tmp_path / "r.mcap", "/whirl/2x-2y/1X")
    assert (first.forward_um, first.backward_um) == pytest.approx((0.0, 10.0), abs=1e-9)
    assert np.isnan(first.compensated_forward_um)  # no slow roll


def test_a_slow_roll_is_taken_off_beside_the_raw_vectors(tmp_path: Path, made: Made) -> None:
    response = made()
    write_response(tmp_path / "r.mcap", dataclasses.replace(response, slow_roll=response.z[0] / 4))
    ((_, first), *_) = read(tmp_path / "r.mcap", "/whirl/1x-1y/1X")
    assert (first.forward_um, first.compensated_forward_um) == pytest.approx((20.0, 15.0))


def test_orbits_stand_in_their_place_along_the_shaft_larger_by_a_round_factor(tmp_path: Path, made: Made) -> None:
    response = made()
    write_response(tmp_path / "r.mcap", response)
    scale = exaggeration(response)
    assert scale == pytest.approx(2000)  # 0.1 of 560 mm over 20 um is 2800
    clouds = read(tmp_path / "r.mcap", "/orbits")
    assert [t for t, _ in clouds] == [round(t * 1e9) for t in response.t]
    for i, colour in ((0, RISING), (-1, FALLING)):
        assert clouds[i][1].frame_id == "rig"
        xyz, colours = points(clouds[i][1])
        orbit = (colours == colour).all(axis=1)
        for at, radius in ((0.2505, 20e-6 * scale), (0.3805, 10e-6 * scale)):
            here = xyz[orbit & np.isclose(xyz[:, 0], at)]
            assert len(here) > 50
            assert np.hypot(here[:, 1], here[:, 2]) == pytest.approx(radius, rel=1e-5)
        dots = xyz[(colours == KEYPHASOR).all(axis=1)]
        assert dots[np.isclose(dots[:, 0], 0.2505)].mean(axis=0) == pytest.approx([0.2505, 20e-6 * scale, 0], abs=1e-6)


def test_the_rig_is_drawn_to_scale(tmp_path: Path, made: Made) -> None:
    write_response(tmp_path / "r.mcap", made())
    ((_, cloud),) = read(tmp_path / "r.mcap", "/rig")
    xyz, _ = points(cloud)
    assert (xyz[:, 0].min(), xyz[:, 0].max()) == pytest.approx((0.0, 0.56))
    assert np.hypot(xyz[:, 1], xyz[:, 2]).max() == pytest.approx(0.0375)  # the disk's radius


def test_rows_that_are_not_usable_make_no_orbit_and_one_line_where_they_begin(tmp_path: Path, made: Made) -> None:
    usable = np.ones((ROWS, 4), dtype=bool)
    usable[2:4] = False
    reasons = tuple(("gap in the samples",) if i in (2, 3) else () for i in range(ROWS))
    remarks = tuple(("missed pulse, bridged",) if i == 7 else () for i in range(ROWS))
    write_response(tmp_path / "r.mcap", made(usable=usable, reasons=reasons, remarks=remarks))
    assert len(read(tmp_path / "r.mcap", "/orbits")) == ROWS - 2
    lines = [(t // 10**9, m.level, m.message) for t, m in read(tmp_path / "r.mcap", "/log")]
    assert lines[0][2].startswith("RK4 with spring bearing")
    assert "drawn 2000 times larger" in lines[0][2]
    assert lines[1:] == [
        (1, 2, "run 'up' begins at 500 rpm, speed rises"),
        (3, 3, "700 rpm, not usable: gap in the samples"),
        (6, 2, "run 'down' begins at 900 rpm, speed falls"),
        (8, 2, "700 rpm, remark: missed pulse, bridged"),
    ]


def test_a_remark_is_said_once_while_only_its_figures_change(tmp_path: Path, made: Made) -> None:
    hum = tuple((f"mains hum at 50.0 Hz falls into {2 + i // 5}X: adds up to 0.{i} um",) for i in range(ROWS))
    write_response(tmp_path / "r.mcap", made(remarks=hum))
    said = [m.message for _, m in read(tmp_path / "r.mcap", "/log") if "remark" in m.message]
    assert [words.split("remark: ")[1] for words in said] == [hum[0][0], hum[5][0]]


def test_the_log_has_no_character_that_ends_the_viewer(tmp_path: Path, made: Made) -> None:
    runs = (Run(name="up ∠轴\n", direction=1), Run(name="Abwärts", direction=-1))
    write_response(tmp_path / "r.mcap", made(runs=runs))
    said = [m.message for _, m in read(tmp_path / "r.mcap", "/log")]
    assert said[1].startswith("run 'up ???' begins")
    assert said[2].startswith("run 'Abwärts' begins")


def test_a_response_of_gaps_alone_has_no_orbits(tmp_path: Path, made: Made) -> None:
    response = made()
    write_response(
        tmp_path / "gap.mcap",
        dataclasses.replace(
            response,
            orders=(0.0,),
            z=response.z[:, :, :1],
            covariance=response.covariance[:, :1],
            slow_roll=response.slow_roll[:, :1],
            slow_roll_covariance=response.slow_roll_covariance[:1],
        ),
    )
    assert len(read(tmp_path / "gap.mcap", "/rig")) == 1
    assert read(tmp_path / "gap.mcap", "/orbits") == []
