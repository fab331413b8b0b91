"""A table of the wrong sign is remarked upon: tables of a numpy rotor, as they are and conjugated."""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.processing.files.bode_table import read_table
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.end_to_end.numpy_rotor import Hidden, mapping, table, vectors, write

UP = {"up": 'direction = "up"'}
RPM = np.linspace(900, 3600, 60)


def read(folder: Path, rig: RigConfig, *, toml: str, planes: tuple[str, ...] = ("1",)) -> OrderTrackedResponse:
    read = vectors(RPM, Hidden(), planes=planes)
    return read_table(*write(folder, table({"up": (RPM, read)}), toml), rig)


def remarks(response: OrderTrackedResponse) -> set[str]:
    return {word for row in response.remarks for word in row}


def test_the_right_sign_is_not_remarked_upon(tmp_path: Path, rk4: RigConfig) -> None:
    assert not remarks(read(tmp_path, rk4, toml=mapping(UP)))


@pytest.mark.parametrize("planes", [("1",), ("1", "2")])
def test_a_lag_taken_for_a_lead_whirls_backward(tmp_path: Path, rk4: RigConfig, planes: tuple[str, ...]) -> None:
    wrong = mapping(UP, planes=planes).replace('phase_is = "lag"', 'phase_is = "phase"')
    (said,) = remarks(read(tmp_path, rk4, toml=wrong, planes=planes))
    assert said.startswith("the vectors of 1x, 1y whirl backward, is the sign of the phases right (phase_is or conj")


def test_a_rotor_turning_the_other_way_is_asked_about(tmp_path: Path, rk4: RigConfig) -> None:
    (said,) = remarks(read(tmp_path, rk4.turned_over, toml=mapping(UP)))
    assert "rotation of the config" in said


def test_a_single_probe_tells_by_its_lag_through_the_peak(tmp_path: Path, rk4: RigConfig) -> None:
    one = mapping(UP).split("[[vectors]]")
    right = "[[vectors]]".join([one[0], one[1]]) + "[[runs]]" + one[2].split("[[runs]]")[1]
    assert not remarks(read(tmp_path, rk4, toml=right))
    (said,) = remarks(read(tmp_path, rk4, toml=right.replace('phase_is = "lag"', 'phase_is = "phase"')))
    assert said.startswith("the vectors of 1x lag less beyond their peak than before it")
