"""Loads of every law and order, and of one that begins on the way, against integration of the envelope in time."""

import math

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import Added, with_added
from rotorrig.sims.rotor.model.loads import Load, unbalance_pattern
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.steady.harmonic_response import load_columns, probe_response
from rotorrig.sims.rotor.swept.swept_response import swept_columns
from rotorrig.sims.rotor.swept.timeline import Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.parameters import defer_rest
from tests.sims.rotor.collocation import RPM, Ramp, integrated

RAMPS = {1: (1800, 30, 24.0), 2: (900, 30, 16.0), 3: (600, 20, 16.0)}  # each through its resonance: rpm, rpm/s, s


@pytest.fixture(scope="module")
def model(full):
    """Two modes, and a stiffness that grows with the speed."""
    tiny = reduce(full, modes=2)
    rows = tiny.bearing("spring").rows
    return with_added(tiny, Added(H=rows.T @ [[2.0, 3.0], [-3.0, 1.0]] @ rows, S=0.01 * rows.T @ rows))


def force(model) -> np.ndarray:
    """Return a force along one axis, (dof,): it excites both whirls."""
    return model.disk("disk").rows[0] * (1 + 0.5j)


def both(model, ramp: Ramp, *, order: int = 1, **load):
    """Return what the rows show, and what they should."""
    rows = tracked_rows(ramp.timeline, t=ramp.rows, revolutions=8, window="hann")
    got = swept_columns(model, rows, loads=[Load(force(model), order=order, **load)], order=order)[..., 0]
    when, _, weight = ramp.window(8, "hann")
    began = np.maximum(when, max(load.get("since", 0), 0))
    amplitude = integrated(model, ramp, force(model), order=order, step=0.01 / order, **load)(began)
    amplitude[when < load.get("since", -math.inf)] = 0
    return got, np.einsum("p,rpk->rk", weight, amplitude)


@pytest.mark.parametrize("law", ["unbalance", "constant"])
@pytest.mark.parametrize("order", defer_rest([1, 2, 3]))
def test_every_law_and_order_is_that_of_integration_in_time(model, order, law):
    start, rate, seconds = RAMPS[order]
    ramp = Ramp(start * RPM, rate * RPM, seconds)
    got, want = both(model, ramp, order=order, law=law)
    assert np.abs(got - want).max() < 1e-4 * np.abs(want).max()
    steady = load_columns(model, ramp.omega(ramp.rows), [Load(force(model), law, order)])[..., 0]
    assert np.abs(steady - want).max() > 0.05 * np.abs(want).max()  # what is being modelled


@pytest.mark.parametrize("since", [9.013, 14.5])
def test_a_load_may_begin_within_a_turn(model, since):
    """Just before the resonance and after it: the transient is that of the integration."""
    ramp = Ramp(1800 * RPM, 30 * RPM, 24.0)
    got, want = both(model, ramp, law="unbalance", since=since)
    error = np.abs(got - want).max(axis=1) / np.abs(want).max()
    assert error.max() < 5e-3  # what the step rings at its own frequencies, not the modes passed
    assert np.median(error) < 3e-4


def test_a_load_that_began_before_the_pulses_has_always_acted_and_one_after_them_never(model):
    ramp = Ramp(1800 * RPM, 30 * RPM, 8.0)
    rows = tracked_rows(ramp.timeline, t=ramp.rows, revolutions=8, window="hann")
    loads = [Load(force(model), "constant", since=since) for since in (-math.inf, -1.0, 0.0, 8.0, 100.0)]
    z = swept_columns(model, rows, loads=loads)
    np.testing.assert_array_equal(z[..., 1], z[..., 0])
    np.testing.assert_array_equal(z[..., 2], z[..., 0])
    np.testing.assert_array_equal(z[..., 3:], 0)


def test_places_by_name_are_loads(small):
    ramp = Ramp(1800 * RPM, 30 * RPM, 8.0)
    rows = tracked_rows(ramp.timeline, t=ramp.rows, revolutions=8, window="hann")
    load = Load(unbalance_pattern(small, {"disk": 1.0}), "unbalance")
    z = swept_columns(small, rows, unbalance=["disk"], loads=[load, Load(force(small), "constant")])
    assert z.shape == (200, len(small.probes), 3)
    np.testing.assert_allclose(z[..., 1], z[..., 0], rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_at_constant_speed_loads_have_their_steady_response(small, order):
    omega = 90.0
    rows = tracked_rows(Timeline(2 * np.pi / omega * np.arange(200)), t=[5.0], revolutions=8, window="hann")
    loads = [Load(force(small), law, order) for law in ("unbalance", "constant")]
    got = swept_columns(small, rows, loads=loads, order=order)
    want = load_columns(small, [omega], loads)
    np.testing.assert_allclose(got, want, atol=1e-8 * np.abs(want).max())


def test_steady_loads_of_several_orders_are_those_of_harmonic_forces(small):
    omega = np.array([40.0, 150.0])
    loads = [Load(force(small), "constant", n) for n in (2, 1, -1, 0)]
    got = load_columns(small, omega, loads)
    for i, load in enumerate(loads):
        want = probe_response(small, omega, force={"disk": (1 + 0.5j, 0)}, order=load.order)
        np.testing.assert_allclose(got[..., i], want, rtol=1e-9, atol=1e-18)


def test_what_cannot_be_asked_is_said(small):
    ramp = Ramp(1800 * RPM, 30 * RPM, 8.0)
    rows = tracked_rows(ramp.timeline, t=ramp.rows, revolutions=8, window="hann")
    with pytest.raises(ValueError, match="load 0 is of order 2, want 1"):
        swept_columns(small, rows, loads=[Load(force(small), "constant", 2)])
    with pytest.raises(ValueError, match=r"load 0: its pattern has shape \(2,\), want"):
        swept_columns(small, rows, loads=[Load(np.zeros(2), "constant")])
    with pytest.raises(ValueError, match="law of a load is 'linear'"):
        Load(np.zeros(2), "linear")
    with pytest.raises(ValueError, match="order is -1, want one above zero"):
        swept_columns(small, rows, loads=[Load(force(small), "constant", -1)], order=-1)
