"""What the probes of a rig see of one effect: order vectors of a run-up and a coast-down, from the forward model.

Every speed is taken as steady and nothing is noisy: what is drawn of it in docs/effects.md is a signature, and no
measurement.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RPM, Plane, RigConfig
from rotorrig.sims.effects import Effect, ReadingContext, Theta
from rotorrig.sims.rotor.model import Load, RotorModel, assemble, reduce, unbalance_pattern
from rotorrig.sims.rotor.nonlinear import steady_with_law
from rotorrig.sims.rotor.steady import load_columns

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Valued = tuple[Effect, Theta]

ORDERS = (1, 2, 3)
LOWEST, HIGHEST, STEP = 480.0, 3600.0, 10.0  # rpm
SLOW_ROLL = 240.0  # rpm, before the run-up
RAMP = 30.0  # rpm/s, up and down alike
HOLD = 1.0  # s at the top
REVOLUTIONS = 8.0  # of a row's window


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """A run-up, a moment at the top and the coast-down, row by row; the slow roll stands last, as effects expect it."""

    rpm: Real  # (row,) of one direction, rising
    omega: Real  # (2 row + 1,) rad/s: up, down, slow roll
    t: Real  # (2 row,) s
    keyphasor_t: Real  # (pulse,) s

    @classmethod
    def even(cls) -> "Sweep":
        """Return the sweep of the constants above: the turns of an even ramp are known in closed form."""
        rpm = np.arange(LOWEST, HIGHEST + STEP / 2, STEP)
        top = (HIGHEST - LOWEST) / RAMP  # s, when it is up
        end = 2 * top + HOLD
        up = (rpm - LOWEST) / RAMP
        turn = np.arange((LOWEST + HIGHEST) / 120 * top + 1)  # LOWEST t / 60 + RAMP t^2 / 120 = turn
        rising = (np.sqrt(LOWEST**2 + 120 * RAMP * turn) - LOWEST) / RAMP
        held = top + np.arange(1, HOLD * HIGHEST / 60) * 60 / HIGHEST
        return cls(
            rpm=rpm,
            omega=np.concatenate([rpm, rpm[::-1], [SLOW_ROLL]]) / RPM,
            t=np.concatenate([up, end - up[::-1]]),
            keyphasor_t=np.concatenate([rising, held, end - rising[::-1]]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Vectors:
    """Order vectors of a sweep, order -> (row, probe) m, 0-peak, x = Re(z e^{j n theta}), speeds rising in both."""

    rpm: Real
    up: dict[int, Complex]
    down: dict[int, Complex]


def vectors(rig: RigConfig, effect: Effect, theta: Theta, sweep: Sweep, *, beside: Valued | None = None) -> Vectors:
    """Return what the probes of `rig` see of its nameplate's unbalance and of `effect` at the values `theta`.

    `beside` is another effect that pushes the rotor anyway, with its values.
    """
    seen = _seen(rig, effect, theta, sweep, beside)
    rows = len(sweep.rpm)
    return Vectors(
        rpm=sweep.rpm,
        up={n: z[:rows] for n, z in seen.items()},
        down={n: z[rows : 2 * rows][::-1] for n, z in seen.items()},
    )


def _seen(rig: RigConfig, effect: Effect, theta: Theta, sweep: Sweep, beside: Valued | None) -> dict[int, Complex]:
    """Return the vectors of all rows, order -> (row + 1, probe)."""
    model = effect.change_matrices(_rotor(rig, effect.places), theta)
    loads = [_unbalance(rig, model), *effect.loads(model, theta)]
    if beside:
        loads += beside[0].loads(model, beside[1])
    laws = effect.force_laws(model, theta)
    if laws:
        amounts = np.ones(len(loads), dtype=complex)
        moved = steady_with_law(model, sweep.omega, loads, amounts, laws, orders=ORDERS)
        motion = {n: moved[..., i] for i, n in enumerate(ORDERS)}
    else:
        motion = {n: _linear(model, loads, sweep, n) for n in ORDERS}
    return {n: effect.change_readings(z, _view(rig, sweep, n, z), theta) for n, z in motion.items()}


def _rotor(rig: RigConfig, places: Mapping[str, float]) -> RotorModel:
    planes = (*rig.planes, *(Plane(name=name, position=z) for name, z in places.items()))
    return reduce(assemble(rig.model_copy(update={"planes": planes})))


def _unbalance(rig: RigConfig, model: RotorModel) -> Load:
    amounts = {d.name: d.unbalance.amount * np.exp(1j * d.unbalance.angle) for d in rig.disks if d.unbalance}
    return Load(unbalance_pattern(model, amounts), "unbalance")


def _linear(model: RotorModel, loads: Sequence[Load], sweep: Sweep, order: int) -> Complex:
    """Return the motion under loads without laws, (row + 1, probe); a load acts from its time on."""
    same = [load for load in loads if load.order == order]
    if not same:
        return np.zeros((len(sweep.omega), len(model.probes)), dtype=complex)
    times = np.append(sweep.t, sweep.t[0])  # the slow roll is before the run-up
    acting = times[:, None] >= np.array([load.since for load in same])
    return np.einsum("rpl,rl->rp", load_columns(model, sweep.omega, same), acting)


def _view(rig: RigConfig, sweep: Sweep, order: int, z: Complex) -> ReadingContext:
    rows = len(sweep.t)
    view = ReadingContext(
        probes=tuple(p.name for p in rig.probes),
        angle=np.array([p.angle for p in rig.probes]),
        position=np.array([p.position for p in rig.probes]),
        order=order,
        omega=sweep.omega,
        t=sweep.t,
        revolutions=np.full(rows, REVOLUTIONS),
        window="hann",
        keyphasor_t=sweep.keyphasor_t,
    )
    return replace(view, slow_roll=z[-1])
