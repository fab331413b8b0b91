"""Order phasors read off a plant's volts with nothing but its keyphasor channel; no code of processing."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_deviations, apply_structure, collect_forces
from rotorrig.sims.plant.force_laws import Force, Motion, Turn
from rotorrig.sims.plant.integrate import ShaftMotion
from rotorrig.sims.plant.plant import GRAVITY, Plant
from rotorrig.sims.plant.shaft import build
from rotorrig.sims.plant.truth import FaultSpec

RPM = np.pi / 30  # rad/s
H = 1e-4  # s, step of the motions below


def falling_edges(volts: NDArray[np.float64], *, level: float = -13.0) -> NDArray[np.float64]:
    """Return fractional sample indices at which `volts` fall through `level`, between neighbouring samples."""
    before = np.flatnonzero((volts[:-1] > level) & (volts[1:] <= level))
    return before + (level - volts[before]) / (volts[before + 1] - volts[before])


def order_phasors(volts: NDArray[np.float64], *, order: int) -> NDArray[np.complex128]:
    """Return z = 2 mean(x e^{-j n theta}) over whole turns (channel,) of all but the last channel, the keyphasor.

    theta = 0 at its falling edges.
    """
    edges = falling_edges(volts[:, -1])
    theta = 2 * np.pi * np.interp(np.arange(len(volts)), edges, np.arange(len(edges)))
    inside = slice(int(np.ceil(edges[0])), int(np.ceil(edges[-1])))
    x = volts[inside, :-1] - volts[inside, :-1].mean(axis=0)
    return 2 * np.mean(x * np.exp(-1j * order * theta[inside])[:, None], axis=0)


def volts_of(plant: Plant, t: float) -> NDArray[np.float64]:
    """Return the volts (sample, channel) of the next `t` seconds."""
    return plant.advance(plant.t + t) * np.array(plant.volts_per_count)


def measured(plant: Plant, t: float, *, order: int = 1) -> NDArray[np.complex128]:
    """Return the order phasors (probe,) [m] of the next `t` seconds, sensitivities as on the nameplate."""
    return order_phasors(volts_of(plant, t), order=order) / 7874.0


def run_to(plant: Plant, rpm: float, *, rate: float = 500.0, settle: float = 3.0) -> Plant:
    """Bring `plant` from the speed it has to another at `rate` [rad/s^2] and let it settle."""
    plant.command(rpm * RPM, rate, True)
    plant.advance(plant.t + abs(rpm * RPM - plant.speed) / rate + settle)
    return plant


def steady(
    rig: RigConfig,
    name: str | None,
    values: dict[str, float],
    *,
    rpm: float,
    order: int = 1,
    also: tuple[str, dict[str, float]] | None = None,
) -> NDArray[np.complex128]:
    """Return the order phasors (probe,) [m] of the nameplate rig with a fault, and `also` another, at one speed."""
    chosen = [pair for pair in ((name, values), also) if pair and pair[0]]
    faults = [FaultSpec(name=n, parameters=v) for n, v in chosen]
    plant = run_to(Plant(rig, nameplate(rig, faults=faults)), rpm)
    return measured(plant, max(1.0, 330 / rpm), order=order)


def difference(
    rig: RigConfig, name: str, values: dict[str, float], *, rpm: float, order: int = 1
) -> NDArray[np.complex128]:
    """Return by how much a fault moves the order phasors (probe,) [m] at a steady speed."""
    return steady(rig, name, values, rpm=rpm, order=order) - steady(rig, None, {}, rpm=rpm, order=order)


def felt(
    force: Force, *, x: float = 0.0, y: float = 0.0, angle: float = 0.0, omega: float = 100.0
) -> tuple[float, float]:
    """Return fx, fy of a force law at a deflection, with nothing to remember yet."""
    turn, motion = Turn(0.0, angle, omega, 0.0, H), Motion(x, y, 0.0, 0.0)
    return force.law(turn, motion, np.array(force.constants), np.zeros(force.memory), np.zeros(force.memory))


def driven(
    force: Force,
    x: NDArray[np.float64],
    y: NDArray[np.float64] | float = 0.0,
    *,
    omega: float = 0.0,
    step: float = H,
) -> NDArray[np.float64]:
    """Return fx, fy (step, 2) of a force law whose place is led along a path that begins at rest in its middle."""
    y = np.broadcast_to(y, x.shape)
    vx, vy = np.gradient(x, step), np.gradient(y, step)
    constants, before, after = np.array(force.constants), np.zeros(force.memory), np.zeros(force.memory)
    forces = np.empty((len(x), 2))
    for i in range(len(x)):
        t = step * (i + 1)
        turn, motion = Turn(t, omega * t, omega, 0.0, step), Motion(x[i], y[i], vx[i], vy[i])
        forces[i] = force.law(turn, motion, constants, before, after)
        before, after = after, before
    return forces


def free_motion(rig: RigConfig, name: str, values: dict[str, float], *, gravity: tuple[float, float]) -> ShaftMotion:
    """Return the shaft of the nameplate rig with a fault, without unbalance, watched at its first disk."""
    truth = apply_deviations(rig, nameplate(rig, faults=[FaultSpec(name=name, parameters=values)]))
    acting = collect_forces(rig, truth)
    plain = build(rig, truth, extra=[c for force in acting for c, _ in force.on])
    rotor = apply_structure(rig, truth, plain)
    return ShaftMotion(rotor, step=H, gravity=gravity, forces=acting, watched=(rig.disks[0].position,))


def settled(rig: RigConfig, name: str, values: dict[str, float]) -> tuple[float, float]:
    """Return where the disk of a shaft that does not turn comes to rest under its weight, x and y [m]."""
    gravity = {"-x": (-GRAVITY, 0.0), "-y": (0.0, -GRAVITY), "none": (0.0, 0.0)}[rig.gravity]
    still = np.zeros(15_000)
    x, y = free_motion(rig, name, values, gravity=gravity).run(still, still, still)[-1, 0]
    return float(x), float(y)


def growth(rig: RigConfig, name: str, values: dict[str, float], *, omega: float, forward: bool) -> float:
    """Return the rate [1/s] at which a forward or backward whirl of the disk grows at a steady speed.

    It starts on a circle; of x + j y = z, the part that whirls forward is (z - j z' / w) / 2, backward with plus.
    """
    motion = free_motion(rig, name, values, gravity=(0.0, 0.0))
    shape = 1e-5 * _first_shape(rig, name, values)
    w = np.sqrt(73.631e3)
    motion.state[0, : len(shape)] = shape
    motion.state[1, len(shape) :] = (1.0 if forward else -1.0) * w * shape
    motion.state[2, : len(shape)] = -(w**2) * shape
    steps = np.arange(1, 2001)
    seen = motion.run(omega * H * steps, np.full(2000, omega), np.zeros(2000))[:, 0]
    z = seen[:, 0] + 1j * seen[:, 1]
    r = np.abs(z - (1j if forward else -1j) * np.gradient(z, H) / w)[100:2000]
    return float(np.polyfit(H * steps[100:2000], np.log(r), 1)[0])


def ring_down(
    rig: RigConfig, name: str, values: dict[str, float], *, amplitude: float, seconds: float
) -> NDArray[np.float64]:
    """Return x (step,) of the disk of a shaft without its damper, let go at `amplitude` [m]."""
    damper = rig.bearings[2].model_copy(update={"cxx": 0.0, "cyy": 0.0})
    rig = rig.model_copy(update={"bearings": (*rig.bearings[:2], damper)})
    motion = free_motion(rig, name, values, gravity=(0.0, 0.0))
    shape = _first_shape(rig, name, values)
    motion.state[0, : len(shape)] = amplitude * shape
    motion.state[2, : len(shape)] = -73.631e3 * amplitude * shape
    steps = round(seconds / H)
    return motion.run(np.zeros(steps), np.zeros(steps), np.zeros(steps))[:, 0, 0]


def upward_crossings(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the times [s] at which x (step,) crosses zero upwards."""
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    return H * (up - x[up] / (x[up + 1] - x[up]))


def _first_shape(rig: RigConfig, name: str, values: dict[str, float]) -> NDArray[np.float64]:
    """Return the shaft's shape under a force at the disk, 1 at the disk, in one plane's coordinates with the fault."""
    truth = nameplate(rig, faults=[FaultSpec(name=name, parameters=values)])
    rotor = build(rig, nameplate(rig), extra=[c for force in collect_forces(rig, truth) for c, _ in force.on])
    force = np.zeros(2 * rotor.n)
    disk = rotor.station(rig.disks[0].position)
    force[disk] = 1.0
    shape = np.linalg.solve(rotor.K, force)[: rotor.n]
    return shape / shape[disk]
