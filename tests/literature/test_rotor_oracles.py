"""The FE rotor against ROSS 2.3.0 (tests/data/oracle/README.md) and against printed values.

The responses agree to rounding: the tolerance is 1e-9 of the peak (measured 3e-11 and 4e-12), where a wrong shear
factor costs 1e-4. Printed values carry four to six digits.
"""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import assemble, with_bearing
from rotorrig.sims.rotor.modes.modes import critical_speeds, whirl_modes
from rotorrig.sims.rotor.steady.harmonic_response import probe_response, steady_response

ORACLE = Path(__file__).parents[1] / "data" / "oracle"
RPM = np.pi / 30
STIFF = np.diag([1e9, 1e9])
NONE = np.zeros((2, 2))


def test_lalanne_unbalance_response_is_that_of_ross(lalanne):
    oracle = np.load(ORACLE / "oracle_lalanne.npz")
    want = np.column_stack([oracle[name] for name in ("X2", "Y2", "X12", "Y12")])
    got = probe_response(assemble(lalanne, max_element=0.1), oracle["rpm"] * RPM, unbalance={"2": 200e-6})
    assert np.abs(got - want).max() < 1e-9 * np.abs(want).max()


@pytest.mark.parametrize(("case", "left"), [("pair", ["left A", "left B"]), ("pinned", ["left B"])])
def test_rk4_unbalance_response_is_that_of_ross(rk4, case, left):
    oracle = np.load(ORACLE / f"oracle_rk4_{case}.npz")
    rig = rk4.model_copy(update={"bearings": tuple(b for b in rk4.bearings if b.name in [*left, "spring"])})
    model = with_bearing(assemble(rig), left, STIFF, NONE)
    np.testing.assert_allclose(model.z, oracle["z_nodes"], atol=1e-12)
    want = np.column_stack([oracle[name] for name in ("X1", "Y1", "X2", "Y2")])
    got = probe_response(model, oracle["rpm"] * RPM, unbalance={"disk": 15e-6})
    assert np.abs(got - want).max() < 1e-9 * np.abs(want).max()


def test_lalanne_natural_frequencies_at_25000_rpm(lalanne):
    want = [55.411, 67.197, 157.898, 193.640, 249.854, 407.470, 446.718, 622.70, 714.92]  # Hz, ROSS
    modes = whirl_modes(assemble(lalanne, max_element=0.1), 25_000 * RPM, count=9)
    got = [abs(mode.eigenvalue) / (2 * np.pi) for mode in modes]  # undamped, as ROSS's wn
    digits = [3, 3, 3, 3, 3, 3, 3, 2, 2]
    assert [round(g, n) for g, n in zip(got, digits, strict=True)] == want


def test_lalanne_damped_critical_speeds(lalanne):
    want = np.array([3620.4, 3798.1, 10017, 11278, 16769, 24399, 26603])  # rpm, ROSS
    got = critical_speeds(assemble(lalanne, max_element=0.1), up_to=30_000 * RPM) / RPM
    assert np.all(abs(got - want) <= [0.05, 0.05, 0.5, 0.5, 0.5, 0.5, 0.5])  # all the digits printed


def test_lalanne_peaks_are_where_and_as_high_as_printed(lalanne):
    model = assemble(lalanne, max_element=0.1)
    rpm = np.arange(3580, 3840)
    q = steady_response(model, rpm * RPM, unbalance={"2": 200e-6})
    at = np.concatenate([model.probes[:2], model.disk("2").rows[:2], model.probes[2:]])  # nodes 2, 6, 12; x and y
    um = np.abs(q @ at.T) * 1e6
    assert list(rpm[um.argmax(axis=0)]) == [3620, 3798] * 3
    peaks = um.max(axis=0)
    assert [round(p, 1) for p in peaks[[0, 1, 4, 5]]] == [383.8, 797.0, 573.4, 1250.4]
    assert [round(p) for p in peaks[2:4]] == [919, 2095]


def test_rk4_criticals_and_growth_are_those_the_config_states(rk4):
    model = assemble(rk4)
    np.testing.assert_allclose(critical_speeds(model, up_to=4000 * RPM) / RPM, [2226, 2237], atol=0.5)
    largest = np.abs(probe_response(model, 2140 * RPM, unbalance={"disk": 15e-6}))[0, 0]
    assert largest * 1e6 == pytest.approx(143, abs=0.5)


def test_the_chapters_lumped_mass_converges_to_the_same_critical_speeds(lalanne):
    consistent = critical_speeds(assemble(lalanne, max_element=0.02), up_to=12_000 * RPM)
    coarse = critical_speeds(assemble(lalanne, max_element=0.1, element="lumped"), up_to=12_000 * RPM)
    fine = critical_speeds(assemble(lalanne, max_element=0.05, element="lumped"), up_to=12_000 * RPM)
    error = [np.abs(lumped / consistent - 1).max() for lumped in (coarse, fine)]
    assert error[0] < 1e-3
    assert error[0] / error[1] == pytest.approx(4, abs=0.5)  # second order in the element's length
