"""What a test needs to see an effect: vectors of a small rotor, straight from its dynamic stiffness."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.config.units import RPM
from rotorrig.sims.effects.base import Effect, ReadingContext
from rotorrig.sims.rotor.model.assembly import RotorModel
from rotorrig.sims.rotor.model.loads import Load
from rotorrig.sims.rotor.steady.harmonic_response import dynamic_stiffness

Complex = NDArray[np.complex128]

ORDERS = (1, 2, 3)
OMEGA = np.array([500.0, 1100.0, 1800.0, 2200.0, 2600.0, 3600.0, 240.0]) / RPM  # the last one is the slow roll
UNBALANCE = 15e-6 * np.exp(0.4j)  # kg m, at the disk


def view(rig: RigConfig, order: int, omega: NDArray[np.float64] = OMEGA) -> ReadingContext:
    """Rows that pass the mains' frequencies: 45 turns a second and 5 more every second, whatever `omega` says."""
    rows = len(omega) - 1
    turn = np.arange(250)
    return ReadingContext(
        probes=tuple(p.name for p in rig.probes),
        angle=np.array([p.angle for p in rig.probes]),
        position=np.array([p.position for p in rig.probes]),
        order=order,
        omega=omega,
        t=np.linspace(0.5, 3.5, rows),
        revolutions=np.full(rows, 8.0),
        window="hann",
        keyphasor_t=np.sqrt(81.0 + 0.4 * turn) - 9.0,  # 45 t + 5 t^2 / 2 = turn
    )


def motion(model: RotorModel, loads: tuple[Load, ...], order: int, omega: NDArray[np.float64] = OMEGA) -> Complex:
    """The probes' displacement, (row, probe), under the loads of one order, at constant speeds."""
    Z = dynamic_stiffness(model, omega, order=order)
    F = np.zeros((len(omega), model.dof), dtype=complex)
    for load in loads:
        if load.order == order:
            law = (order * omega) ** 2 if load.law == "unbalance" else np.ones(len(omega))
            F += law[:, None] * load.pattern
    if order == 1 and model.added.T is not None:  # Z q + T q* / 2 = F, in real and imaginary parts
        n, T = model.dof, model.added.T / 2
        whole = np.block([[Z.real + T.real, T.imag - Z.imag], [Z.imag + T.imag, Z.real - T.real]])
        q = np.linalg.solve(whole, np.concatenate([F.real, F.imag], axis=1)[..., None])[..., 0]
        return (q[:, :n] + 1j * q[:, n:]) @ model.probes.T
    return np.linalg.solve(Z, F[..., None])[..., 0] @ model.probes.T


def base_load(model: RotorModel, amount: complex = UNBALANCE) -> Load:
    rows = model.disks[0].rows
    return Load(amount * (rows[0] - 1j * model.rotation * rows[1]), "unbalance")


def predicted(
    effect: Effect,
    theta: Mapping[str, float],
    *,
    rig: RigConfig,
    model: RotorModel,
    base: bool = True,
    omega: NDArray[np.float64] = OMEGA,
) -> dict[int, Complex]:
    """Order -> vectors (row, probe), of the base's unbalance and the effect; force laws left out."""
    changed = effect.change_matrices(model, theta)
    loads = effect.loads(changed, theta) + ((base_load(changed),) if base else ())
    return {n: effect.change_readings(motion(changed, loads, n, omega), view(rig, n, omega), theta) for n in ORDERS}


def typical(effect: Effect, share: float = 1.0) -> dict[str, float]:
    """Every unknown `share` of its size from nothing."""
    return {p.name: p.at_zero + share * p.size for p in effect.parameters}


def simple_rig(probes: list[dict], *, k: float = 40e3, c: float = 10.0, **changes: object) -> RigConfig:
    """A shaft on two like bearings at its ends with a disk in the middle, SI."""
    table: dict = {
        "name": "by hand",
        "shaft": {"length": 0.4, "diameter": 0.01, "density": 7800.0, "youngs_modulus": 210e9},
        "disks": [{"name": "disk", "position": 0.2, "mass": 0.8, "polar_inertia": 5e-4, "transverse_inertia": 3e-4}],
        "bearings": [
            {"name": name, "position": z, "kxx": k, "kyy": k, "cxx": c, "cyy": c}
            for name, z in (("A", 0.0), ("B", 0.4))
        ],
        "probes": [{**probe, "channel": channel} for channel, probe in enumerate(probes)],
    }
    return from_si({**table, **changes})


def pair_at(position: float, *, turned: float = 0.0, names: tuple[str, str] = ("x", "y")) -> list[dict]:
    """Two probes a right angle apart."""
    angles = (turned, turned + np.pi / 2)
    return [{"name": n, "position": position, "angle": angle} for n, angle in zip(names, angles, strict=True)]
