"""Order vectors out: the convention stands in the file, and what others read of it is what was written."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyuff

from rotorrig.processing.files import response_csv, response_uff
from rotorrig.processing.files.bode_table import read_table
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.processing.files.test_bode_table import PLAIN, Files

RPM = np.pi / 30


@pytest.fixture
def response(tmp_path: Path, rk4: RigConfig) -> OrderTrackedResponse:
    """Two rows of one probe: z = 10 um at -30 deg and 20 um at -60 deg; the second probe has none."""
    read = Files(tmp_path, rk4).read(table="rpm,amp,phase\n1000,10,-30\n1010,20,-60\n", mapping=PLAIN)
    slow = read.slow_roll.copy()
    slow[0, 0] = 3e-6 - 1e-6j
    return replace(read, slow_roll=slow, slow_roll_omega=240 * RPM)


def test_pyuff_reads_the_order_functions(response: OrderTrackedResponse, tmp_path: Path) -> None:
    assert response_uff.write_uff(tmp_path / "out.uff", response) == 1
    units, vectors = pyuff.UFF(str(tmp_path / "out.uff")).read_sets()
    assert (units["type"], units["units_code"], units["length"], units["temp_offset"]) == (164, 1, 1.0, 273.15)
    assert (vectors["func_type"], vectors["ord_data_type"], vectors["z_axis_value"]) == (27, 6, 1.0)
    assert (vectors["abscissa_spec_data_type"], vectors["ordinate_spec_data_type"]) == (19, 8)
    assert (vectors["abscissa_axis_units_lab"], vectors["ordinate_axis_units_lab"]) == ("rpm", "m")
    assert (vectors["rsp_ent_name"], vectors["id1"]) == ("1x", "1x 1X, run up")
    assert "0-peak" in vectors["id2"] and "phase lag = -arg z" in vectors["id2"]
    assert vectors["id3"] == "raw; slow roll 3.000000e-06 -1.000000e-06j m at 240.0 rpm"
    np.testing.assert_allclose(vectors["x"], [1000, 1010])
    np.testing.assert_allclose(vectors["data"], [1e-5 * np.exp(-1j * np.pi / 6), 2e-5 * np.exp(-1j * np.pi / 3)])


def test_the_bytes_are_in_the_columns_of_the_specification(response: OrderTrackedResponse, tmp_path: Path) -> None:
    response_uff.write_uff(tmp_path / "out.uff", response)
    lines = (tmp_path / "out.uff").read_text().splitlines()
    at = lines.index("    58")
    assert lines[at - 1] == "    -1" and lines[-1] == "    -1"
    # 2(I5,I10),2(1X,10A1,I10,I4): type 27, entity, node 1, direction +X
    assert lines[at + 6] == "   27         0    0         0 1x                 1   1 NONE               0   0"
    # 3I10,3E13.5: complex double, two points, uneven; the order
    assert lines[at + 7] == "         6         2         0  0.00000e+00  0.00000e+00  1.00000e+00"
    # I10,3I5,2(1X,20A1)
    assert lines[at + 8] == "        19    0    0    0 speed                rpm                 "
    # E13.5,2E20.12
    assert lines[at + 12] == "  1.00000E+03  8.660254037844E-06 -5.000000000000E-06"


def test_a_csv_of_vectors_comes_back_through_a_mapping(response: OrderTrackedResponse, tmp_path: Path) -> None:
    assert response_csv.write_csv(tmp_path / "out.csv", response) == 2
    mapping = (
        PLAIN.replace('"rpm"', '"speed [rpm]"')
        .replace('"amp"', '"1x 1X amplitude [um]"')
        .replace('"phase"\nunit', '"1x 1X phase lag [deg]"\nunit')
        .replace('phase_is = "phase"', 'phase_is = "lag"')
    )
    (tmp_path / "mapping.toml").write_text(mapping)
    back = read_table(tmp_path / "out.csv", tmp_path / "mapping.toml", response.rig)
    np.testing.assert_allclose(back.z[:, 0], response.z[:, 0], rtol=1e-7)
    np.testing.assert_allclose(back.omega, response.omega, rtol=1e-6)


def test_the_convention_stands_in_the_csv(response: OrderTrackedResponse, tmp_path: Path) -> None:
    response_csv.write_csv(tmp_path / "out.csv", response)
    head = (tmp_path / "out.csv").read_text().splitlines()
    assert head[0] == "# order vectors, raw; amplitude um 0-peak; phase lag deg = -arg z, z = 2 mean(x exp(-j theta)),"
    assert "rotation from x to y" in head[3] and "forward" in head[4]
    assert head[5].endswith("mean of its vector over unknown turns under the weights 'rectangular'; method unknown")
    names, cells = head[6].split(","), head[7].split(",")
    assert names[4:6] == ["1x 1X amplitude [um]", "1x 1X phase lag [deg]"]
    assert cells[4:6] == ["10", "30"]
    assert cells[9:-2] == [""] * (15 + 12)


@pytest.fixture
def whirling(response: OrderTrackedResponse) -> OrderTrackedResponse:
    """The same with 1y: an orbit of 3 um forward at a lag of 20 deg and 1 um backward at one of 50."""
    forward, backward = 3e-6 * np.exp(-1j * np.radians(20)), 1e-6 * np.exp(-1j * np.radians(50))
    z = response.z.copy()
    z[:, 0, 0], z[:, 1, 0] = forward + backward, -1j * (forward - backward)  # x and y of f e^{jt} + b* e^{-jt}
    covariance = np.tile((0.1e-6) ** 2 * np.eye(8), (2, 1, 1, 1))
    usable = np.array([[True, True, False, False]] * 2)
    slow = np.full_like(response.slow_roll, np.nan)
    slow[:2, 0] = 1e-6, -1e-6j  # forward alone
    return replace(
        response,
        z=z,
        covariance=covariance,
        usable=usable,
        slow_roll=slow,
        reasons=(("2x: clipped",), ()),
        remarks=((), ("hum", "bridged")),
        slow_roll_remarks=("too fast",),
    )


def test_forward_and_backward_whirl_stand_in_the_csv(whirling: OrderTrackedResponse, tmp_path: Path) -> None:
    response_csv.write_csv(tmp_path / "out.csv", whirling)
    lines = (tmp_path / "out.csv").read_text().splitlines()
    assert lines[6] == "# slow roll: too fast"
    rows = [dict(zip(lines[7].split(","), line.split(","), strict=True)) for line in lines[8:]]
    for name, amplitude, lag in (("+1X", 3, 20), ("-1X", 1, 50)):
        assert float(rows[0][f"1x/1y {name} amplitude [um]"]) == pytest.approx(amplitude)
        assert float(rows[0][f"1x/1y {name} phase lag [deg]"]) == pytest.approx(lag)
        # f = (x + jy) / 2 of independent x and y: a variance of (s^2 + s^2) / 4
        assert float(rows[0][f"1x/1y {name} sigma [um]"]) == pytest.approx(0.1 / np.sqrt(2))
        assert rows[0][f"2x/2y {name} amplitude [um]"] == ""
    assert [(row["reasons"], row["remarks"]) for row in rows] == [("2x: clipped", ""), ("", "hum; bridged")]


@pytest.mark.parametrize(
    ("turns", "csv", "uff"),
    [((8.0, 8.0), "8 turns", "hann 8 turns"), ((4.0, 31.4159), "4 to 31.4159 turns", "hann 4 turns")],
)
def test_the_window_that_a_model_has_to_apply_is_told(
    whirling: OrderTrackedResponse, tmp_path: Path, turns: tuple[float, float], csv: str, uff: str
) -> None:
    windowed = replace(whirling, window="hann", method="resampling", revolutions=np.array(turns))
    response_csv.write_csv(tmp_path / "out.csv", windowed)
    said = f"# a row is the mean of its vector over {csv} under the weights 'hann'; method resampling"
    assert said in (tmp_path / "out.csv").read_text().splitlines()
    response_uff.write_uff(tmp_path / "out.uff", windowed)
    _, vectors, *_ = pyuff.UFF(str(tmp_path / "out.uff")).read_sets()
    assert vectors["id4"] == f"theta = 0 at keyphasor edge; rotor x-to-y; x to probe; {uff}"


def test_pyuff_reads_forward_and_backward_whirl(whirling: OrderTrackedResponse, tmp_path: Path) -> None:
    assert response_uff.write_uff(tmp_path / "out.uff", whirling) == 4
    *_, forward, backward = pyuff.UFF(str(tmp_path / "out.uff")).read_sets()
    assert (forward["z_axis_value"], backward["z_axis_value"]) == (1.0, -1.0)
    assert (forward["id1"], backward["id1"]) == ("1x/1y +1X forward, run up", "1x/1y -1X backward, run up")
    assert forward["id2"] == "m radius, x + jy = f e^jn theta + b* e^-jn theta; phase lag = -arg"
    assert forward["id3"].startswith("raw; slow roll 1.000000e-06 ")
    assert backward["id3"].startswith("raw; slow roll 0.000000e+00 ")
    np.testing.assert_allclose(forward["data"], 3e-6 * np.exp(-1j * np.radians(20)))
    np.testing.assert_allclose(backward["data"], 1e-6 * np.exp(-1j * np.radians(50)))
