"""Time stepping under a force law, turn by turn: where it rests, and against integration of the vibration in time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotorrig.sims.rotor.model.assembly import RotorModel, assemble
from rotorrig.sims.rotor.model.loads import unbalance_loads
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.nonlinear.steady_response import steady_with_law
from rotorrig.sims.rotor.nonlinear.swept_motion import LawSweep
from rotorrig.sims.rotor.swept.timeline import TURN, Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.sims.rotor import jeffcott
from tests.sims.rotor.collocation import RPM, Ramp
from tests.sims.rotor.nonlinear.test_swept_response import at_disk, cubic, friction

U = 15e-6 * np.exp(0.6j)
CENTRE = (2e-5, -1e-5)  # m: the mean force and the second harmonic are then in it


@pytest.fixture(scope="module")
def model() -> RotorModel:
    return reduce(assemble(jeffcott.rig(), max_element=0.1))


def sweep(model: RotorModel, timeline: Timeline, t: np.ndarray, law) -> LawSweep:
    rows = tracked_rows(timeline, t=t, revolutions=10, window="hann")
    return LawSweep(model, rows, unbalance_loads(model, ["disk"]), np.array([U]), [law])


def test_at_a_constant_speed_it_stays_in_the_steady_state(model):
    omega = 205.0
    law = at_disk(model, cubic, 2e10, static=CENTRE)
    timeline = Timeline(np.arange(121) * TURN / omega)
    stepped = sweep(model, timeline, timeline.t[[20, 60, 100]], law).solve()
    whole = assemble(jeffcott.rig(), max_element=0.1)
    of_whole = at_disk(whole, cubic, 2e10, static=CENTRE)
    (want,) = steady_with_law(whole, [omega], unbalance_loads(whole, ["disk"]), [U], [of_whole], orders=(1,))
    first = stepped.u[:, 2:4] + 1j * stepped.u[:, 4:6]
    np.testing.assert_allclose(first, np.broadcast_to(want[:, 0], first.shape), atol=1e-6 * np.abs(want).max())
    np.testing.assert_allclose(stepped.u, np.broadcast_to(stepped.u[0], stepped.u.shape), atol=1e-11)


@pytest.mark.parametrize(
    ("force", "constants", "tolerance"),
    [(cubic, (2e10,), 2e-3), (friction, (0.3, 1e-3), 5e-3)],
    ids=["cubic", "friction"],
)
def test_every_turn_it_is_where_integration_in_time_is(model, force, constants, tolerance):
    """At the keyphasor's mark x = mean + Re(Q1 + Q2 + Q3); the equations of motion are written out here once more."""
    ramp = Ramp(1700 * RPM, 60 * RPM, 12.0)
    law = at_disk(model, force, *constants)
    stepped = sweep(model, ramp.timeline, ramp.rows[(ramp.rows > 2) & (ramp.rows < 10)], law).solve()
    turns = np.flatnonzero((ramp.timeline.t > 6) & (ramp.timeline.t < 10))
    stiffness, angle = np.array([jeffcott.KX, jeffcott.KY]), np.angle(U)

    def motion(now, s):
        omega, theta = ramp.omega(now), ramp.theta(now) + angle
        turning = np.array([np.exp(1j * theta), -1j * np.exp(1j * theta)])
        unbalance = (abs(U) * (omega**2 - 1j * ramp.rate) * turning).real
        by = np.array(force(s[0], s[1], s[2], s[3], law.constants))
        return np.concatenate([s[2:], (unbalance + by - jeffcott.C * s[2:] - stiffness * s[:2]) / jeffcott.M])

    want = (
        solve_ivp(motion, (0, 10), np.zeros(4), "DOP853", t_eval=ramp.timeline.t[turns], rtol=1e-8, atol=1e-12).y[:2].T
    )
    got = stepped.u[turns].reshape(-1, 7, 2)[:, [0, 1, 3, 5]].sum(axis=1)
    assert np.abs(got - want).max() < tolerance * np.abs(want).max()
