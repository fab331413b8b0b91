"""Rows of a table in any order, and trial masses in its columns."""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.processing.files.bode_table import read_table
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.errors import ConfigError, DataError
from tests.conftest import CONFIGS

RPM = np.pi / 30
VECTORS = """
[speed]
column = "rpm"
unit = "1 rpm"
[[vectors]]
probe = "1x"
amplitude = "amp"
phase = "phase"
unit = "1 um"
phase_is = "phase"
phase_unit = "1 deg"
[uncertainty]
absolute = "1 um"
"""
UP, DOWN = '[[runs]]\nname = "up"\ndirection = "up"\n', '[[runs]]\nname = "down"\ndirection = "down"\n'
TWO = 'run_column = "run"\n' + VECTORS + UP + 'value = "u"\n' + DOWN + 'value = "d"\n'
SORTED = """run,rpm,amp,phase
u,1000,10,-30
u,1100,20,-60
u,1200,30,-90
d,1200,29,-91
d,1100,19,-61
d,1000,9,-31
"""
MASSES = """
[[trial_columns]]
plane_column = "plane"
amount = "mass"
amount_unit = "1 g mm"
angle = "at"
angle_unit = "1 deg"
"""


@pytest.fixture
def rig() -> RigConfig:
    """The rk4 with a massless plane."""
    return parse(
        (CONFIGS / "rk4.toml").read_text() + '\n[[planes]]\nname = "coupling hub"\nposition = "30 mm"\n', where="rk4"
    )


def read(folder: Path, rig: RigConfig, table: str, mapping: str):
    (folder / "t.csv").write_text(table)
    (folder / "t.toml").write_text(mapping)
    return read_table(folder / "t.csv", folder / "t.toml", rig)


@pytest.mark.parametrize("seed", range(5))
def test_shuffled_rows_of_several_runs_are_those_of_the_sorted_table(tmp_path: Path, rig: RigConfig, seed: int) -> None:
    head, *rows = SORTED.splitlines()
    np.random.default_rng(seed).shuffle(rows)
    shuffled = read(tmp_path, rig, "\n".join([head, *rows]) + "\n", TWO)
    whole = read(tmp_path, rig, SORTED, TWO)
    for name in ("run", "omega", "z", "covariance", "usable"):
        np.testing.assert_array_equal(getattr(shuffled, name), getattr(whole, name), err_msg=name)
    assert whole.remarks == ()


def test_rows_that_were_sorted_are_remarked_upon(tmp_path: Path, rig: RigConfig) -> None:
    table = "rpm,amp,phase\n1200,30,-90\n1000,10,-30\n1100,20,-60\n"
    response = read(tmp_path, rig, table, VECTORS + UP)
    np.testing.assert_allclose(response.omega / RPM, [1000, 1100, 1200])
    np.testing.assert_allclose(np.abs(response.z[:, 0, 0]), [10e-6, 20e-6, 30e-6])
    assert response.remarks[0][0].startswith("rows of the run 'up' were not in the order of speed, and were sorted")


def test_an_error_behind_a_shuffled_row_names_the_line_of_the_file(tmp_path: Path, rig: RigConfig) -> None:
    with pytest.raises(DataError, match="row 3, column 'amp': got -1"):
        read(tmp_path, rig, "rpm,amp,phase\n1200,30,-90\n1000,-1,-30\n1100,20,-60\n", VECTORS + UP)


def test_consecutive_revolutions_stay_in_their_order_and_must_go_one_way(tmp_path: Path, rig: RigConfig) -> None:
    mapping = VECTORS + UP + 'rows = "one per revolution"\n'
    table = "rpm,amp,phase\n1000,10,-30\n1005,20,-60\n1004,30,-90\n"
    np.testing.assert_allclose(read(tmp_path, rig, table, mapping).omega / RPM, [1000, 1005, 1004])
    with pytest.raises(DataError, match="row 3, column 'rpm': got 900 after 1000, want speeds that only rise in run"):
        read(tmp_path, rig, "rpm,amp,phase\n1000,1,0\n900,1,0\n", mapping)
    with pytest.raises(DataError, match="row 4, column 'rpm': got 1000 after 900, want speeds that only fall in run"):
        rows = "rpm,amp,phase\n1000,1,0\n900,1,0\n1000,1,0\n"
        read(tmp_path, rig, rows, mapping.replace('"up"', '"down"'))


def test_dwells_may_rise_or_fall_and_are_sorted_where_they_do_neither(tmp_path: Path, rig: RigConfig) -> None:
    dwell = VECTORS + '[[runs]]\nname = "steps"\ndirection = "dwell"\n'
    for rpm, after in (([1000, 900, 800], [1000, 900, 800]), ([900, 1000, 800], [800, 900, 1000])):
        table = "rpm,amp,phase\n" + "".join(f"{n},1,0\n" for n in rpm)
        np.testing.assert_allclose(read(tmp_path, rig, table, dwell).omega / RPM, after)


def test_trial_masses_in_columns_divide_a_run_by_what_was_on(tmp_path: Path, rig: RigConfig) -> None:
    table = "rpm,amp,phase,plane,mass,at\n1000,1,0,,,\n1000,2,0,disk,12,90\n1100,3,0,coupling hub,5,0\n1100,4,0,,0,\n"
    response = read(tmp_path, rig, table, VECTORS + UP + MASSES)
    names = ["up, no trial mass", "up, disk: 12 g mm at 90 deg", "up, coupling hub: 5 g mm at 0 deg"]
    assert [run.name for run in response.runs] == names
    np.testing.assert_array_equal(response.run, [0, 0, 1, 2])
    np.testing.assert_allclose(np.abs(response.z[:, 0, 0]), [1e-6, 4e-6, 2e-6, 3e-6])
    assert response.runs[0].trial_unbalance == {}
    assert response.runs[1].trial_unbalance["disk"] == pytest.approx(12e-6j)
    assert response.runs[2].trial_unbalance == {"coupling hub": pytest.approx(5e-6)}


def test_a_run_with_one_mass_in_all_rows_keeps_its_name_and_two_columns_add(tmp_path: Path, rig: RigConfig) -> None:
    second = '[[trial_columns]]\nplane = "disk"\namount = "g"\namount_unit = "1 g mm"\nangle = "rad"\n'
    second += 'angle_unit = "1 rad"\n'
    table = "rpm,amp,phase,plane,mass,at,g,rad\n1000,1,0,disk,12,90,3,0\n1100,2,0,disk,12,90,3,0\n"
    response = read(tmp_path, rig, table, VECTORS + UP + MASSES + second)
    assert [run.name for run in response.runs] == ["up"]
    assert response.runs[0].trial_unbalance["disk"] == pytest.approx(3e-6 + 12e-6j)


def test_a_trial_in_the_mapping_may_be_on_any_plane(tmp_path: Path, rig: RigConfig) -> None:
    trial = 'trial = [{ disk = "coupling hub", amount = "5 g mm", angle = "180 deg" }]\n'
    response = read(tmp_path, rig, "rpm,amp,phase\n1000,1,0\n", VECTORS + UP + trial)
    assert response.runs[0].trial_unbalance["coupling hub"] == pytest.approx(-5e-6)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("disc,12,90", r"row 2, column 'plane': got 'disc', want a disk or plane of the config, one of \['disk'"),
        ("disk,-1,90", "row 2, column 'mass': got -1, want an amount from 0 up"),
        ("disk,12,", "row 2, column 'at': got nothing beside an amount, want an angle"),
        ("disk,much,90", "row 2, column 'mass': got 'much', want a number"),
    ],
)
def test_a_mistake_in_a_trial_column_is_said_with_its_place(
    tmp_path: Path, rig: RigConfig, row: str, words: str
) -> None:
    with pytest.raises(DataError, match=words):
        read(tmp_path, rig, f"rpm,amp,phase,plane,mass,at\n1000,1,0,{row}\n", VECTORS + UP + MASSES)


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        (MASSES.replace('plane_column = "plane"\n', ""), r"trial_columns\[0\]: want plane, a disk or plane of the"),
        (MASSES.replace('plane_column = "plane"', 'plane = "d"'), r"trial_columns\[0\].plane: the config has no disk"),
        (MASSES.replace("1 deg", "0 deg"), r"trial_columns\[0\].angle_unit: got 0 rad, want what a 1 stands for"),
        (
            'trial = [{ disk = "disk", amount = "5 g mm", angle = "0 deg" }]\n' + MASSES,
            "runs: 'up' has a trial beside trial_columns",
        ),
    ],
)
def test_a_mistake_in_the_mapping_of_trial_columns_is_said(
    tmp_path: Path, rig: RigConfig, mapping: str, words: str
) -> None:
    with pytest.raises(ConfigError, match=words):
        read(tmp_path, rig, "rpm,amp,phase,plane,mass,at\n1000,1,0,disk,1,0\n", VECTORS + UP + mapping)


def test_a_mass_beyond_all_rotors_is_said_with_its_row(tmp_path: Path, rig: RigConfig) -> None:
    with pytest.raises(ConfigError, match=r"t.csv: row 2: amount: got 1e\+24 kg m, want at most 1000 kg m"):
        read(tmp_path, rig, "rpm,amp,phase,plane,mass,at\n1000,1,0,disk,1e30,0\n", VECTORS + UP + MASSES)


def test_a_slow_roll_with_several_masses_is_refused(tmp_path: Path, rig: RigConfig) -> None:
    table = "rpm,amp,phase,plane,mass,at\n240,1,0,,,\n240,1,0,disk,12,90\n"
    with pytest.raises(DataError, match="row 3, column 'mass': got other trial masses than above"):
        read(tmp_path, rig, table, VECTORS + UP.replace("up", "slow roll", 1).replace('"up"', '"dwell"') + MASSES)
