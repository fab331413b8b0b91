"""Velocities, accelerations and amplitudes alone: what a table of them says of the displacement."""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.processing.files.bode_table import read_table
from rotorrig.processing.files.response_mcap import read_response, write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError, DataError

RPM = np.pi / 30
SPEED = '[speed]\ncolumn = "rpm"\nunit = "1 rpm"\n'
RUN = '[[runs]]\nname = "up"\ndirection = "up"\n'
STATED = '[uncertainty]\nabsolute = "1 um"\n'
VECTOR = '[[vectors]]\nprobe = "1x"\namplitude = "amp"\n'
PHASE = 'phase = "phase"\nphase_is = "phase"\nphase_unit = "1 deg"\n'
HUNDRED = 100 / RPM  # rpm, of 100 rad/s


@pytest.fixture
def read(tmp_path: Path, rk4: RigConfig):
    def read_one(table: str, mapping: str) -> OrderTrackedResponse:
        (tmp_path / "t.csv").write_text(table)
        (tmp_path / "t.toml").write_text(mapping)
        return read_table(tmp_path / "t.csv", tmp_path / "t.toml", rk4)

    return read_one


@pytest.mark.parametrize(
    ("keys", "z"),
    [
        ('unit = "1 um"\n', 1e-6),
        # x = A cos(theta + phase) has v = A omega cos(theta + phase + 90 deg): 1 mm/s at 100 rad/s are 10 um, 90 later
        ('unit = "1 mm/s"\n', 1e-5 * np.exp(-0.5j * np.pi)),
        ('unit = "1 in/s"\n', 25.4e-5 * np.exp(-0.5j * np.pi)),
        ('unit = "1 mm/s"\namplitude_is = "rms"\n', np.sqrt(2) * 1e-5 * np.exp(-0.5j * np.pi)),
        ('unit = "1 mm/s"\namplitude_is = "peak-to-peak"\n', 0.5e-5 * np.exp(-0.5j * np.pi)),
        ('unit = "1 m/s^2"\n', -1e-4),  # a = -omega^2 x
    ],
)
def test_a_velocity_or_acceleration_becomes_a_displacement(read, keys: str, z: complex) -> None:
    table = f"rpm,amp,phase\n{HUNDRED},1,30\n{2 * HUNDRED},0,0\n"
    turned = np.exp(1j * np.pi / 6)
    response = read(table, SPEED + VECTOR + PHASE + keys + RUN + STATED)
    assert response.z[0, 0, 0] == pytest.approx(z * turned)
    lag = PHASE.replace('phase_is = "phase"', 'phase_is = "lag"')
    assert read(table, SPEED + VECTOR + lag + keys + RUN + STATED).z[0, 0, 0] == pytest.approx(z / turned)


@pytest.mark.parametrize("conjugated", [False, True])
def test_real_and_imaginary_velocities_do_likewise(read, conjugated: bool) -> None:
    keys = f'[[vectors]]\nprobe = "1x"\nreal = "re"\nimaginary = "im"\nunit = "1 mm/s"\nconjugated = {conjugated}\n'
    response = read(f"rpm,re,im\n{HUNDRED},3,4\n{2 * HUNDRED},0,0\n", SPEED + keys.lower() + RUN + STATED)
    v = (3 - 4j if conjugated else 3 + 4j) * 1e-3
    assert response.z[0, 0, 0] == pytest.approx(v / 100j)


def test_an_order_is_divided_by_its_own_frequency(read) -> None:
    keys = VECTOR + 'order = 2.0\nunit = "1 mm/s"\n' + PHASE
    response = read(f"rpm,amp,phase\n{HUNDRED},1,90\n{2 * HUNDRED},0,0\n", SPEED + keys + RUN + STATED)
    assert response.z[0, 0, 0] == pytest.approx(1e-3 / 200)


def test_an_uncertainty_may_be_stated_as_a_velocity(read) -> None:
    mapping = SPEED + VECTOR + PHASE + 'unit = "1 mm/s"\n' + RUN + '[uncertainty]\nabsolute = "0.1 mm/s"\n'
    response = read(f"rpm,amp,phase\n{HUNDRED},1,0\n{2 * HUNDRED},1,0\n", mapping)
    np.testing.assert_allclose(np.sqrt(response.covariance[:, 0, 0, 0]), [1e-6, 0.5e-6])


def test_a_velocity_that_is_no_vibration_is_refused_with_its_row(read) -> None:
    with pytest.raises(DataError, match="row 2, column 'amp': got 200000, want a vibration of less than 1 m"):
        read(f"rpm,amp,phase\n{HUNDRED},200000,0\n", SPEED + VECTOR + PHASE + 'unit = "1 mm/s"\n' + RUN + STATED)


@pytest.mark.parametrize("unit", ["1 kg", "1", "0 mm/s", "1 mm"])
def test_a_unit_is_one_of_a_vibration(read, unit: str) -> None:
    mapping = SPEED + VECTOR + PHASE + f'unit = "{unit}"\n' + RUN + STATED
    if unit == "1 mm":
        read(f"rpm,amp,phase\n{HUNDRED},0.1,0\n", mapping)
        return
    wanted = "want a velocity above zero" if unit == "0 mm/s" else "want a length with its unit.*, or a velocity or an"
    with pytest.raises(ConfigError, match=rf"unit: got '{unit}'.*{wanted}"):
        read(f"rpm,amp,phase\n{HUNDRED},1,0\n", mapping)


# --- amplitudes alone

ALONE = SPEED + VECTOR + 'unit = "1 um"\n' + RUN + STATED


def test_amplitudes_alone_are_stored_as_such(read, tmp_path: Path) -> None:
    response = read("rpm,amp\n1000,10\n1010,20\n", ALONE)
    assert response.amplitudes_alone
    np.testing.assert_allclose(response.z[:, 0, 0], [1e-5, 2e-5])
    np.testing.assert_allclose(np.sqrt(response.covariance[:, 0, 0, 0]), 1e-6)
    write_response(tmp_path / "r.mcap", response)
    assert read_response(tmp_path / "r.mcap").amplitudes_alone
    assert not read("rpm,amp,phase\n1000,10,0\n", ALONE.replace('"amp"\n', '"amp"\n' + PHASE)).amplitudes_alone


def test_amplitudes_of_a_velocity_are_divided_by_the_speed(read) -> None:
    response = read(f"rpm,amp\n{HUNDRED},1\n{2 * HUNDRED},1\n", ALONE.replace('"1 um"\n[[runs', '"1 mm/s"\n[[runs'))
    np.testing.assert_allclose(response.z[:, 0, 0], [1e-5, 0.5e-5])


def test_the_scatter_of_amplitudes_is_that_of_their_one_part(read) -> None:
    rng = np.random.default_rng(1)
    amplitudes = 50 + 2 * rng.standard_normal(400)
    table = "rpm,amp\n" + "".join(f"{1000 + i},{a:.6f}\n" for i, a in enumerate(amplitudes))
    sigma = np.sqrt(read(table, ALONE.replace(STATED, "")).covariance[:, 0, 0, 0])
    assert np.median(sigma) == pytest.approx(np.hypot(2e-6, 0.003 * 50e-6), rel=0.15)


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        (
            ALONE + VECTOR.replace("1x", "1y") + PHASE + 'unit = "1 um"\n',
            r"vectors\[0\]: has an amplitude alone and others have a phase, want that of all or of none",
        ),
        (
            ALONE + '[slow_roll]\nspeed = "300 rpm"\nvectors = [{probe="1x", amplitude="4 um", phase="0 deg"}]\n',
            "slow_roll.vectors: cannot be told from amplitudes alone",
        ),
        (ALONE.replace('name = "up"', 'name = "slow roll"'), "runs: a 'slow roll' is a vector, want phases too"),
        (
            ALONE.replace('"amp"\n', '"amp"\nphase_is = "lag"\n'),
            "want the columns amplitude and phase, or real and imaginary, or amplitude alone",
        ),
        (ALONE.replace('"amp"\n', '"amp"\norder = 0.0\n').replace('"1 um"', '"1 mm/s"', 1), "a mean position has no"),
    ],
)
def test_what_amplitudes_alone_cannot_have_is_refused(read, mapping: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        read("rpm,amp\n1000,10\n1010,20\n", mapping)
