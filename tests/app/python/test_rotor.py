"""`rr.Rotor`: critical speeds, unbalance response, ROSS and back."""

from pathlib import Path

import numpy as np
import pytest

import rotorrig as rr

JEFFCOTT = """
name = "Jeffcott"
[shaft]
length = "600 mm"
diameter = "10 mm"
youngs_modulus = "200 GPa"
density = "1 kg/m^3"
[[disks]]
name = "disk"
position = "300 mm"
mass = "1 kg"
polar_inertia = "1e-6 kg m^2"
transverse_inertia = "1e-6 kg m^2"
[[bearings]]
name = "a"
position = "0 mm"
kxx = "1e9 N/m"
kyy = "1e9 N/m"
cxx = "0 N s/m"
cyy = "0 N s/m"
[[bearings]]
name = "b"
position = "600 mm"
kxx = "1e9 N/m"
kyy = "1e9 N/m"
cxx = "0 N s/m"
cyy = "0 N s/m"
[[probes]]
name = "x"
position = "300 mm"
angle = "0 deg"
channel = 0
[[probes]]
name = "y"
position = "300 mm"
angle = "90 deg"
channel = 1
"""


@pytest.fixture
def jeffcott(tmp_path: Path) -> rr.Rotor:
    (tmp_path / "j.toml").write_text(JEFFCOTT)
    return rr.Rotor.from_config(tmp_path / "j.toml")


def test_a_disk_on_a_light_shaft_has_the_critical_speed_of_the_textbook(jeffcott: rr.Rotor) -> None:
    stiffness = 48 * 200e9 * np.pi * 0.01**4 / 64 / 0.6**3  # of a simply supported beam at its middle
    want = np.sqrt(stiffness / 1.0) * 30 / np.pi
    assert jeffcott.critical_speeds(up_to_rpm=3000)[0] == pytest.approx(want, rel=2e-3)


def test_it_runs_with_its_unbalance_far_below_the_critical_speed_and_about_its_mass_centre_far_above(
    jeffcott: rr.Rotor,
) -> None:
    u = 1e-5 * np.exp(1j * np.radians(40))  # kg m: 10 um of eccentricity on 1 kg
    slow, fast = jeffcott.unbalance_response([10.0, 30_000.0], {"disk": u})[:, 0]
    assert np.degrees(np.angle(slow)) == pytest.approx(40.0, abs=0.1)
    assert fast == pytest.approx(-u, rel=0.01)


def test_a_plane_that_is_not_there_is_named_with_those_that_are(jeffcott: rr.Rotor) -> None:
    with pytest.raises(rr.DataError, match="'impeller' is no plane of Jeffcott, want one of disk"):
        jeffcott.unbalance_response([100.0], {"impeller": 1e-6})


def test_by_way_of_ross_it_stays_the_rotor_it_was(tmp_path: Path) -> None:
    rotor = rr.Rotor.from_config("rk4")
    again = rr.Rotor.from_ross(rotor.to_ross(tmp_path / "ross.toml"))
    np.testing.assert_allclose(again.critical_speeds(up_to_rpm=6000), rotor.critical_speeds(up_to_rpm=6000), rtol=1e-6)
    assert isinstance(rr.read(tmp_path / "ross.toml"), rr.Rotor)


def test_it_prints_its_parts_and_saves_its_config(tmp_path: Path) -> None:
    rotor = rr.Rotor.from_config("rk4")
    assert "disk at 280 mm" in repr(rotor) and "disk at 280 mm" in rotor._repr_html_()
    assert rr.read(rotor.save(tmp_path / "again.toml")).rig.hash == rotor.rig.hash


def test_a_config_that_is_not_bundled_is_said() -> None:
    with pytest.raises(rr.ConfigError, match="config 'rk5': is neither a file nor bundled"):
        rr.Rotor.from_config("rk5")
