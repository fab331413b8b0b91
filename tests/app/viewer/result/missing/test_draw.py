"""Where the pictures of a missing force have their marks: places and forces of `make_missing`, by hand."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from rotorrig.app.viewer.result.missing.over_motion import HEIGHT as TALL
from rotorrig.app.viewer.result.missing.over_motion import WIDTH
from rotorrig.app.viewer.result.missing.place import HEIGHT
from rotorrig.app.viewer.result.view import write_result_rrd
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.processing.response import OrderTrackedResponse
from tests.app.conftest import make_missing


@pytest.fixture(scope="module")
def drawn(
    response: OrderTrackedResponse, named: Diagnosis, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, np.ndarray]:
    """The points of every picture of the missing force, (point, 2) by entity, of a line's first strip."""
    path = tmp_path_factory.mktemp("missing") / "result.rrd"
    write_result_rrd(path, response, None, dataclasses.replace(named, missing=make_missing()))
    return points(path)


def points(path: Path) -> dict[str, np.ndarray]:
    found = {}
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        for column in batch.schema.names:
            if str(chunk.entity_path).startswith("/missing/") and column.endswith((":positions", ":strips")):
                values = batch.column(column)[0].as_py()
                found[str(chunk.entity_path)] = np.array(values[0] if column.endswith(":strips") else values)
    return found


def test_the_most_probable_place_stands_over_the_bearing(
    drawn: dict[str, np.ndarray], response: OrderTrackedResponse
) -> None:
    curve, per_m = drawn["/missing/place/curve"], 186.0 / response.rig.shaft.length
    assert curve[np.argmin(curve[:, 1]), 0] == pytest.approx(0.48 * per_m, abs=0.011 * per_m)  # y points down
    assert curve[0].tolist() == pytest.approx([0.0, HEIGHT], abs=1e-3)  # nothing at the coupling
    spring = next(bearing for bearing in response.rig.bearings if bearing.name == "spring")
    names = drawn["/missing/place/bearings/names"]
    assert names[-1, 0] == pytest.approx(spring.position * per_m, abs=1e-3)
    assert len(names) == 2, "left A and left B stand too near for two names"


def test_the_force_stands_over_its_motion(drawn: dict[str, np.ndarray]) -> None:
    measured, over = drawn["/missing/motion/measured"], make_missing().over_speed
    assert over is not None
    largest = int(np.argmax(np.abs(over.motion[:, 0])))
    motion, force = np.abs(over.motion[largest, 0]) * 1e6, np.abs(over.force[largest, 0]) * 1e3  # um, mN
    assert measured[largest] == pytest.approx([WIDTH * motion / 50, TALL * (1 - force / 80)], abs=1e-3)  # nice axes
    assert (np.diff(drawn["/missing/motion/law"][:, 0]) >= 0).all()


def test_a_reading_that_is_missing_has_words_alone(
    tmp_path: Path, response: OrderTrackedResponse, named: Diagnosis
) -> None:
    nowhere = {"places": np.zeros(0), "probability": np.zeros(0), "over_speed": None, "kind": "reading"}
    write_result_rrd(
        tmp_path / "result.rrd", response, None, dataclasses.replace(named, missing=make_missing(**nowhere))
    )
    assert points(tmp_path / "result.rrd") == {}
