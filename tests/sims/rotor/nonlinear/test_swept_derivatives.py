"""Derivatives under force laws: against central differences of the response, and where the law is a spring."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import Added, RotorModel, assemble, with_added, with_geometry
from rotorrig.sims.rotor.model.derivatives import along_position, finite_difference
from rotorrig.sims.rotor.model.loads import unbalance_loads
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.law_changes import LawChange
from rotorrig.sims.rotor.nonlinear.steady_response import steady_law_derivatives, steady_with_law
from rotorrig.sims.rotor.nonlinear.swept_derivatives import swept_law_derivatives
from rotorrig.sims.rotor.nonlinear.swept_response import swept_with_law
from rotorrig.sims.rotor.steady.harmonic_response import load_columns
from rotorrig.sims.rotor.swept.swept_response import swept_columns
from tests.sims.rotor import jeffcott
from tests.sims.rotor.nonlinear.test_swept_response import DOWN, U, at_disk, cubic, error, friction, laid_out, spring
from tests.sims.rotor.swept.test_swept_derivatives import UP, rows_of

OMEGA = np.linspace(180, 260, 9)  # rad/s
OFF_CENTRE = (2e-5, -1e-5)  # m, so that the mean and 2X are in it


@pytest.fixture(scope="module")
def model():
    return reduce(assemble(jeffcott.rig(), max_element=0.1))


@pytest.fixture(scope="module")
def rows():
    return laid_out(*DOWN)[1]


def changed(law: ForceLaw, *, constant: float = 0.0, rest: float = 0.0) -> tuple[ForceLaw, ...]:
    constants = law.constants.copy()
    constants[0] *= 1 + constant
    return (replace(law, constants=constants, static=law.static + np.array([rest, 0.0])),)


def stiffer(model: RotorModel, share: float) -> RotorModel:
    at = model.disk("disk").rows[:2]
    return with_added(model, Added(K=share * 3e4 * at.T @ at, C=share * 10.0 * at.T @ at))


def response(model, rows, amount, laws):
    return swept_with_law(model, rows, unbalance_loads(model, ["disk"]), [amount], laws, orders=(1, 2))


def steady(model, omega, amount, laws):
    return steady_with_law(model, omega, unbalance_loads(model, ["disk"]), [amount], laws, orders=(1, 2))


@pytest.mark.parametrize("law", [(cubic, 1e10), (friction, 0.1, 1e-3)], ids=["cubic", "friction"])
@pytest.mark.parametrize("swept", [True, False], ids=["swept", "steady"])
def test_derivatives_are_those_of_the_response(model, small, rows, law, swept):
    model = model if swept else small
    law = at_disk(model, *law, static=OFF_CENTRE)
    h, moved = 1e-4, 1e-8
    changes = [
        LawChange(amounts=np.array([U])),
        LawChange(amounts=np.array([1j * U])),
        LawChange(direction=finite_difference(model, stiffer(model, h), h)),
        LawChange(laws=changed(law, constant=h), step=h),
        LawChange(laws=changed(law, rest=moved), step=moved),
    ]
    show, where = (response, rows) if swept else (steady, OMEGA)
    ahead, behind = (
        [
            show(model, where, U * (1 + s * h), [law]),
            show(model, where, U * (1 + 1j * s * h), [law]),
            show(stiffer(model, s * h), where, U, [law]),
            show(model, where, U, changed(law, constant=s * h)),
            show(model, where, U, changed(law, rest=s * moved)),
        ]
        for s in (1, -1)
    )
    derive = swept_law_derivatives if swept else steady_law_derivatives
    loads = unbalance_loads(model, ["disk"])
    z, by = derive(model, where, loads, [U], [law], changes=changes, orders=(1, 2))
    np.testing.assert_allclose(z, show(model, where, U, [law])[..., 0], rtol=0, atol=1e-8 * np.abs(z).max())
    for k, (plus, minus) in enumerate(zip(ahead, behind, strict=True)):
        want = (plus - minus) / (2 * (moved if k == 4 else h))
        if np.abs(want[..., 0]).max() > 1e-6 * np.abs(ahead[0]).max():
            assert error(by[1][..., k], want[..., 0]) < 1e-3, k
        if law.force is cubic:
            assert error(by[2][..., k], want[..., 1]) < (0.2 if swept else 1e-3), k


@pytest.mark.parametrize("swept", [True, False], ids=["swept", "steady"])
@pytest.mark.parametrize("part", ["disk disk", "bearing left B", "probe 1x"])
def test_they_are_so_by_positions_too(adjustable, part, swept):
    """The law goes with the disk."""
    model = with_geometry(adjustable, positions={"disk disk": 3e-3})
    law, h = at_disk(model, cubic, 1e10), 2e-6
    show, where = (response, rows_of(UP, 40)) if swept else (steady, OMEGA)
    derive = swept_law_derivatives if swept else steady_law_derivatives
    changes = [LawChange(direction=along_position(model, part))]
    got = derive(model, where, unbalance_loads(model, ["disk"]), [U], [law], changes=changes).by[1][..., 0]
    start = {"disk disk": 3e-3}
    ahead, behind = (
        show(with_geometry(adjustable, positions=start | {part: start.get(part, 0.0) + p}), where, U, [law])[..., 0]
        for p in (h, -h)
    )
    want = (ahead - behind) / (2 * h)
    assert np.abs(want).max() > 1e-3 * np.abs(ahead).max()
    assert error(got, want) < 1e-3


def test_under_a_spring_they_are_those_of_a_stiffer_rotor(model, small, rows):
    for rotor in (model, small):
        law = at_disk(rotor, spring, 2e3, 4.0)
        as_spring = with_added(rotor, Added(K=2e3 * law.rows.T @ law.rows, C=4.0 * law.rows.T @ law.rows))
        loads, unit = unbalance_loads(rotor, ["disk"]), [LawChange(amounts=np.array([1.0 + 0j]))]
        if rotor is model:
            by = swept_law_derivatives(rotor, rows, loads, [U], [law], changes=unit).by[1]
            assert error(by, swept_columns(as_spring, rows, loads=loads)) < 2e-3
        else:
            by = steady_law_derivatives(rotor, OMEGA, loads, [U], [law], changes=unit).by[1]
            np.testing.assert_allclose(by, load_columns(as_spring, OMEGA, loads), rtol=1e-5)
