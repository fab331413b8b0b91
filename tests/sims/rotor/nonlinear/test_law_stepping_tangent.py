"""The tangent of time stepping under force laws, turn by turn, against central differences of the stepping itself."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.model.loads import unbalance_loads
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.nonlinear.harmonic_balance import phasor, slopes
from rotorrig.sims.rotor.nonlinear.law_changes import LawChange
from rotorrig.sims.rotor.nonlinear.law_stepping_tangent import step_tangent
from rotorrig.sims.rotor.nonlinear.swept_motion import LawMotion, LawSweep
from rotorrig.sims.rotor.nonlinear.tangent_forcing import compute_forcing
from tests.sims.rotor import jeffcott
from tests.sims.rotor.nonlinear.test_swept_response import U, at_disk, cubic, error, friction, laid_out

CENTRE = np.array([2e-5, -1e-5])  # m
H, MOVED = 1e-4, 1e-8


@pytest.mark.parametrize("law", [(cubic, 1e10), (friction, 0.1, 1e-3)], ids=["cubic", "friction"])
def test_modes_and_forces_of_every_turn_follow_amounts_and_laws(law):
    model = reduce(assemble(jeffcott.rig(), max_element=0.1))
    _, rows = laid_out(2450, -120, 5.0)
    law = at_disk(model, *law, static=CENTRE)
    stiff = law.constants * (1 + H * (np.arange(len(law.constants)) == 0))

    def sweep(amount=U, **of_law) -> LawSweep:
        return LawSweep(model, rows, unbalance_loads(model, ["disk"]), np.array([amount]), [replace(law, **of_law)])

    def difference(ahead: LawMotion, behind: LawMotion, by: float) -> tuple[np.ndarray, np.ndarray]:
        return (ahead.a - behind.a) / (2 * by), (phasor(ahead.F, 2) - phasor(behind.F, 2)) / (2 * by)

    want = {
        "amount": difference(sweep(U * (1 + H)).solve(), sweep(U * (1 - H)).solve(), H),
        "constant": difference(sweep(constants=stiff).solve(), sweep(constants=2 * law.constants - stiff).solve(), H),
    }
    changes = [
        LawChange(amounts=np.array([U])),
        LawChange(laws=(replace(law, constants=stiff),), step=H),
    ]
    if law.force is cubic:  # friction does not know where the place rests
        aside = np.array([MOVED, 0.0])
        ahead, behind = (sweep(static=CENTRE + by).solve() for by in (aside, -aside))
        want["rest"] = difference(ahead, behind, MOVED)
        changes.append(LawChange(laws=(replace(law, static=CENTRE + aside),), step=MOVED))
    for name, da, dF in zip(want, *of_tangent(sweep(), changes), strict=True):
        assert error(da, want[name][0]) < 2e-3, name
        assert error(dF, want[name][1]) < 2e-3, name


def of_tangent(sweep: LawSweep, changes: list[LawChange]) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of the modes and of the force's first harmonic, (change, turn, mode or place)."""
    motion, envelope = sweep.solve(), sweep.envelope
    forcing = compute_forcing(sweep, motion, changes)
    a, _, dF, _ = step_tangent(
        *(envelope.operator, envelope.steps, envelope.phases, sweep.participation, sweep.shapes, sweep.flexibility),
        *(sweep.mean, motion.overtones, motion.u, motion.F, slopes(sweep.laws, sweep.rows.turns.omega, motion.u)),
        *(forcing.force, forcing.force_mid, forcing.motion, forcing.law_force, forcing.law_columns),
    )
    return np.moveaxis(a, -1, 0), np.moveaxis(dF, -1, 0)
