"""Bode tables of others: every convention comes out as the README's, and every mistake as a sentence."""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.processing.files.bode_table import read_table
from rotorrig.rig.config.description import RigConfig, load
from rotorrig.rig.errors import ConfigError, DataError

KFUPM = Path(__file__).parents[2] / "data" / "kfupm-rk4"
CONFIGS = Path(__file__).parents[3] / "configs"
RPM = np.pi / 30

HEAD = """
[speed]
column = "rpm"
unit = "1 rpm"
"""
VECTOR = """
[[vectors]]
probe = "1x"
amplitude = "amp"
phase = "phase"
unit = "1 um"
phase_is = "phase"
phase_unit = "1 deg"
"""
UP = """
[[runs]]
name = "up"
direction = "up"
"""
STATED = """
[uncertainty]
absolute = "1 um"
"""
PLAIN = HEAD + VECTOR + UP + STATED
TABLE = "rpm,amp,phase\n1000,10,-30\n1010,20,-60\n1020,30,-90\n"


class Files:
    """A table and its mapping in a folder."""

    def __init__(self, folder: Path, rig: RigConfig) -> None:
        self._csv, self._mapping, self._rig = folder / "bode.csv", folder / "bode.toml", rig

    def read(self, *, table: str = TABLE, mapping: str = PLAIN):
        self._csv.write_text(table)
        self._mapping.write_text(mapping)
        return read_table(self._csv, self._mapping, self._rig)


@pytest.fixture
def files(tmp_path: Path, rk4: RigConfig) -> Files:
    return Files(tmp_path, rk4)


def test_amplitude_and_phase_become_a_vector(files: Files) -> None:
    response = files.read()
    np.testing.assert_allclose(
        response.z[:, 0, 0], 1e-5 * np.array([1, 2, 3]) * np.exp(-1j * np.pi / 6 * np.array([1, 2, 3]))
    )
    np.testing.assert_allclose(response.omega, np.array([1000, 1010, 1020]) * RPM)
    assert response.orders == (1.0,)
    assert response.runs[0].direction == 1


@pytest.mark.parametrize(
    ("old", "new", "factor"),
    [
        ('unit = "1 um"', 'unit = "127 um"', 127.0),
        ('unit = "1 um"', 'unit = "1 mil"', 25.4),
        ('unit = "1 um"', 'unit = "1 um"\namplitude_is = "peak-to-peak"', 0.5),
        ('unit = "1 um"', 'unit = "1 um"\namplitude_is = "rms"', np.sqrt(2)),
        ('phase_is = "phase"', 'phase_is = "lag"', np.exp(2j * np.pi / 6)),
        ('phase_unit = "1 deg"', 'phase_unit = "-1 deg"', None),
    ],
)
def test_every_unit_and_convention_is_converted(files: Files, old: str, new: str, factor: complex | None) -> None:
    plain = files.read().z[0, 0, 0]
    if factor is None:
        with pytest.raises(ConfigError, match="phase_unit"):
            files.read(mapping=PLAIN.replace(old, new))
    else:
        assert files.read(mapping=PLAIN.replace(old, new)).z[0, 0, 0] == pytest.approx(plain * factor)


def test_real_and_imaginary_columns_are_taken_as_they_are(files: Files) -> None:
    mapping = HEAD + UP + STATED + '[[vectors]]\nprobe = "1x"\nreal = "re"\nimaginary = "im"\nunit = "1 um"\n'
    response = files.read(mapping=mapping, table="rpm,re,im\n1000,3,-4\n1010,1,2\n")
    np.testing.assert_allclose(response.z[:, 0, 0], [3e-6 - 4e-6j, 1e-6 + 2e-6j])


def test_conjugated_columns_are_conjugated_back(files: Files) -> None:
    complex_columns = '[[vectors]]\nprobe = "1x"\nreal = "re"\nimaginary = "im"\nunit = "1 um"\n'
    table = "rpm,re,im\n1000,3,4\n1010,1,2\n"
    for key, imaginary in (("", 1), ("conjugated = false\n", 1), ("conjugated = true\n", -1)):
        response = files.read(mapping=HEAD + UP + STATED + complex_columns + key, table=table)
        np.testing.assert_allclose(response.z[:, 0, 0], [3e-6 + imaginary * 4e-6j, 1e-6 + imaginary * 2e-6j])


SUBTRACTED = '[slow_roll]\nspeed = "300 rpm"\n'


def test_compensated_vectors_are_restored_by_what_was_subtracted(files: Files) -> None:
    stated = SUBTRACTED + 'vectors = [{ probe = "1x", amplitude = "4 um", phase = "90 deg" }]\n'
    raw, restored = files.read(mapping=PLAIN + stated), files.read(mapping="compensated = true\n" + PLAIN + stated)
    np.testing.assert_allclose(restored.z[:, 0, 0], raw.z[:, 0, 0] + 4e-6j)
    np.testing.assert_allclose(restored.compensated()[:, 0], raw.z[:, 0, 0])
    np.testing.assert_array_equal(restored.usable, raw.usable)
    assert np.isnan(restored.compensation_omega), "what it holds is raw"


def test_compensated_by_vectors_nobody_kept_the_speed_is_noted(files: Files) -> None:
    response = files.read(mapping="compensated = true\n" + PLAIN + SUBTRACTED)
    np.testing.assert_allclose(response.z[:, 0, 0], files.read().z[:, 0, 0])
    assert response.compensation_omega == pytest.approx(300 * RPM)
    assert response.slow_omega == pytest.approx(300 * RPM)
    assert np.isnan(response.slow_roll).all() and np.isnan(response.slow_roll_omega)


WITH_SLOW_ROLL = HEAD.replace("[speed]", 'compensated = true\nrun_column = "run"\n[speed]') + VECTOR + """
[[runs]]
name = "slow roll"
direction = "dwell"
value = "s"
[[runs]]
name = "up"
direction = "up"
value = "u"
""" + STATED  # fmt: skip


def test_the_speed_may_be_that_of_slow_roll_rows_which_are_then_zero(files: Files) -> None:
    table = "run,rpm,amp,phase\ns,240,0.3,0\ns,240,0.3,180\nu,1000,9,0\nu,1010,7,0\n"
    response = files.read(mapping=WITH_SLOW_ROLL, table=table)
    assert response.compensation_omega == pytest.approx(240 * RPM)
    assert np.isnan(response.slow_roll).all()


def test_slow_roll_rows_of_a_compensated_table_that_are_not_zero_are_refused(files: Files) -> None:
    table = "run,rpm,amp,phase\ns,240,30,0\ns,240,30,0\nu,1000,9,0\nu,1010,7,0\n"
    with pytest.raises(DataError, match=r"'slow roll' has 30.* um at probe '1x', order 1, .* in \[slow_roll\]"):
        files.read(mapping=WITH_SLOW_ROLL, table=table)


def test_probes_that_the_table_lacks_are_there_but_not_usable(files: Files) -> None:
    response = files.read()
    assert response.probes == ("1x", "1y", "2x", "2y")
    np.testing.assert_array_equal(response.usable, np.tile([True, False, False, False], (3, 1)))
    assert response.reasons[0] == ("1y: not in the table", "2x: not in the table", "2y: not in the table")


def test_rows_without_a_value_are_masked(files: Files) -> None:
    response = files.read(table="rpm,amp,phase\n1000,10,-30\n1010,nan,-60\n1020,,\n1030,5,0\n")
    np.testing.assert_array_equal(response.usable[:, 0], [True, False, False, True])
    assert response.reasons[1][0] == "1x: no value"


def test_consecutive_revolutions_say_when_they_were(files: Files) -> None:
    response = files.read(
        mapping=PLAIN.replace("[uncertainty]", 'rows = "one per revolution"\n[uncertainty]'),
        table="rpm,amp,phase\n600,1,0\n1200,1,0\n2400,1,0\n",
    )
    np.testing.assert_allclose(response.keyphasor_t, [0, 0.1, 0.15, 0.175])
    np.testing.assert_allclose(response.t, [0.05, 0.125, 0.1625])
    assert (response.revolutions == 1).all() and response.window == "rectangular"


def test_without_a_ramp_or_consecutive_revolutions_no_time_is_known(files: Files) -> None:
    response = files.read()
    assert np.isnan(response.t).all() and np.isnan(response.revolutions).all() and len(response.keyphasor_t) == 0
    assert np.isnan(response.alpha).all() and not response.derived_times


def test_several_runs_with_a_trial_mass_and_a_slow_roll(files: Files) -> None:
    mapping = HEAD.replace("[speed]", 'run_column = "run"\n[speed]') + VECTOR + """
[[runs]]
name = "slow roll"
direction = "dwell"
value = "s"
[[runs]]
name = "down with 12 g mm"
direction = "down"
value = "d"
revolutions = 8
trial = [{ disk = "disk", amount = "12 g mm", angle = "90 deg" }]
""" + STATED  # fmt: skip
    response = files.read(mapping=mapping, table="run,rpm,amp,phase\ns,240,3,0\ns,240,3,0\nd,1000,9,0\nd,900,7,0\n")
    np.testing.assert_array_equal(response.run, [0, 0, 1, 1])
    assert [run.direction for run in response.runs] == [0, -1]
    assert response.runs[1].trial_unbalance["disk"] == pytest.approx(12e-6j)
    assert response.slow_roll[0, 0] == pytest.approx(3e-6)
    assert response.slow_roll_omega == pytest.approx(240 * RPM)
    assert response.slow_roll_covariance[0, 0, 0] == pytest.approx(1e-12 / 2)
    np.testing.assert_array_equal(response.revolutions[2:], [8, 8])


def test_a_slow_roll_vector_may_be_stated(files: Files) -> None:
    stated = '[slow_roll]\nspeed = "300 rpm"\nvectors = [{ probe = "1x", amplitude = "4 um", phase = "90 deg" }]\n'
    response = files.read(mapping=PLAIN + stated)
    assert response.slow_roll[0, 0] == pytest.approx(4e-6j)
    np.testing.assert_allclose(response.compensated()[0, 0], response.z[0, 0, 0] - 4e-6j)


def test_stated_uncertainty_adds_in_squares(files: Files) -> None:
    response = files.read(mapping=PLAIN + "relative = 0.1\n")
    np.testing.assert_allclose(response.covariance[2, 0, :2, :2], (1e-12 + 9e-12) * np.eye(2))


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("rpm,amp\n1000,10\n", r"want one column 'phase', got the columns \['rpm', 'amp'\]"),
        ("rpm,amp,phase,amp\n1000,10,0,1\n", "want one column 'amp', got two columns of that name"),
        ("rpm,amp,phase\n", "has 0 rows below its header"),
        ("rpm,amp,phase\n1000,10,0\n1010,2e6,0\n", "row 3, column 'amp': got 2e\\+06, want a vibration of less"),
        ("rpm,amp,phase\n1000,10,0\n1e300,1,0\n", "row 3, column 'rpm': got 1e\\+300, want the speed of a rotor"),
        ("", "has 0 rows below its header"),
        ("rpm,amp,phase\n1000,10,0\n1010,ten,0\n", r"bode.csv: row 3, column 'amp': got 'ten', want a number"),
        ("rpm,amp,phase\n1000,inf,0\n", "row 2, column 'amp': got 'inf', want a finite number"),
        ("rpm,amp,phase\n1000,-1,0\n", "row 2, column 'amp': got -1, want an amplitude from 0 up"),
        ("rpm,amp,phase\n1000,1,0\n-5,1,0\n", "row 3, column 'rpm': got '-5', want a speed above 0"),
        ("rpm,amp,phase\n1000,1,0\n,1,0\n", "row 3, column 'rpm': got '', want a speed above 0"),
        ("# made in 1999\nrpm,amp,phase\n1000,1,0\n1001,1\n", "row 4: got 2 cells, want 3 as in the header"),
    ],
)
def test_a_mistake_in_the_table_is_said_with_its_place(files: Files, table: str, words: str) -> None:
    with pytest.raises(DataError, match=words):
        files.read(table=table)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('probe = "1x"', 'probe = "3x"', r"vectors\[0\].probe: the config has no probe '3x', want one of"),
        ('unit = "1 um"', "unit = 1", "vectors.*unit: got 1, want a length with its unit"),
        ('phase_is = "phase"', 'phase_ist = "phase"', "did you mean 'phase_is'"),
        ('phase = "phase"\n', "", "want the columns amplitude and phase, or real and imaginary"),
        ('phase_is = "phase"\n', "", 'want phase_is = "phase" or "lag"'),
        ('direction = "up"', 'direction = "upwards"', "direction: got 'upwards'"),
        (
            'name = "up"',
            'name = "up"\ntrial = [{disk = "d", amount = "1 g mm", angle = "0 deg"}]',
            "no disk or plane 'd'",
        ),
        ('absolute = "1 um"', "relative = 0.0", "uncertainty: want absolute with its unit"),
        (STATED, '[uncertainty]\nabsolute = "5 g"', "uncertainty.absolute: got '5 g'"),
        (UP, UP + '[[runs]]\nname = "up"\ndirection = "up"\n', "two are named 'up'"),
        ("[speed]", "[speed", "is no valid TOML"),
        (
            'phase_unit = "1 deg"',
            'phase_unit = "1 deg"\nconjugated = true',
            r"vectors\[0\].conjugated: has no meaning for",
        ),
        (
            "[speed]",
            "compensated = true\n[speed]",
            r"compensated: want the vectors that were subtracted in \[slow_roll\]",
        ),
        (STATED, STATED + SUBTRACTED, "slow_roll.vectors: is empty, want its vectors"),
        ('direction = "up"', 'direction = "dwell"\nramp = "30 rpm/s"', r"runs\[0\].ramp: a dwell has none"),
        (
            'direction = "up"',
            'direction = "up"\nrows = "one per revolution"\nramp = "30 rpm/s"',
            r"runs\[0\].ramp: rows are one per revolution and tell the times, want one of the two",
        ),
    ],
)
def test_a_mistake_in_the_mapping_is_said_with_its_key(files: Files, old: str, new: str, words: str) -> None:
    assert old in PLAIN
    with pytest.raises(ConfigError, match=words):
        files.read(mapping=PLAIN.replace(old, new))


@pytest.mark.parametrize("key", ['phase_is = "lag"', 'phase_unit = "1 deg"'])
def test_how_a_phase_counts_is_refused_where_there_is_none(files: Files, key: str) -> None:
    mapping = HEAD + UP + STATED + f'[[vectors]]\nprobe = "1x"\nreal = "re"\nimaginary = "im"\nunit = "1 um"\n{key}\n'
    words = rf"vectors\[0\].{key.split()[0]}: has no meaning for real and imaginary, want conjugated = true where"
    with pytest.raises(ConfigError, match=words):
        files.read(mapping=mapping, table="rpm,re,im\n1000,3,-4\n1010,1,2\n")


def test_of_a_compensated_table_all_vectors_subtracted_are_wanted(files: Files) -> None:
    second = VECTOR.replace('"1x"', '"1y"')
    stated = SUBTRACTED + 'vectors = [{ probe = "1x", amplitude = "4 um", phase = "90 deg" }]\n'
    with pytest.raises(ConfigError, match="slow_roll: probe '1y' at order 1 is missing, want what was subtracted"):
        files.read(mapping="compensated = true\n" + PLAIN + second + stated)


def test_too_few_rows_to_estimate_the_uncertainty_from_is_said(files: Files) -> None:
    with pytest.raises(DataError, match=r"bode.csv: a run has 3 rows with values, want more than 7"):
        files.read(mapping=PLAIN.replace(STATED, ""))


def test_a_value_no_run_has_is_said(files: Files) -> None:
    mapping = PLAIN.replace("[speed]", 'run_column = "run"\n[speed]').replace('name = "up"', 'name = "up"\nvalue = "u"')
    with pytest.raises(DataError, match=r"row 3, column 'run': got 'x', want one of \['u'\]"):
        files.read(mapping=mapping, table="run,rpm,amp,phase\nu,1000,1,0\nx,1010,1,0\n")


def test_missing_files_are_said(tmp_path: Path, rk4: RigConfig) -> None:
    (tmp_path / "m.toml").write_text(PLAIN)
    with pytest.raises(DataError, match=r"none\.csv: cannot be read"):
        read_table(tmp_path / "none.csv", tmp_path / "m.toml", rk4)
    with pytest.raises(ConfigError, match=r"none\.toml: cannot be read"):
        read_table(tmp_path / "none.csv", tmp_path / "none.toml", rk4)


def test_the_measured_run_up_of_a_real_rk4_is_read() -> None:
    rig = load(CONFIGS / "kfupm-rk4.toml")
    response = read_table(KFUPM / "runup_bode_1037_2610rpm.csv", KFUPM / "mapping.toml", rig)
    assert response.z.shape == (210, 1, 1)
    assert response.usable.all()
    first = response.z[0, 0, 0]  # 0.065797 file units at -80.341 degrees, 127 um each
    assert abs(first) == pytest.approx(0.065797 * 127e-6)
    assert np.degrees(np.angle(first)) == pytest.approx(-80.341)
    peak = int(np.argmax(np.abs(response.z[:, 0, 0])))
    assert response.omega[peak] / RPM == pytest.approx(1650, abs=25)  # README: the first critical, about 1650 rpm
    assert response.keyphasor_t[-1] == pytest.approx(np.sum(60 / (response.omega / RPM)))
    sigma = np.sqrt(response.covariance[:, 0, 0, 0])
    assert 0.1e-6 < sigma.min() < sigma.max() < 4e-6  # by eye from the table: 0.5 um before, 2 um after the critical


def test_the_disks_inertias_are_those_of_their_geometry() -> None:
    # polar m (D^2 + d^2) / 8, transverse m ((D^2 + d^2) / 16 + w^2 / 12) of 0.8 kg, 76 x 25 mm, 10 mm bore
    for disk in load(CONFIGS / "kfupm-rk4.toml").disks:
        assert disk.polar_inertia == pytest.approx(0.8 * (0.076**2 + 0.010**2) / 8, rel=1e-3)
        assert disk.transverse_inertia == pytest.approx(0.8 * ((0.076**2 + 0.010**2) / 16 + 0.025**2 / 12), rel=1e-3)
