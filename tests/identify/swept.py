"""Recordings of the rotor model swept up and down, an effect and noise in them: what a diagnosis must find."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from rotorrig.rig.provenance import Provenance
from rotorrig.sims.effects.base import Effect, ReadingContext
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble, with_bearing
from rotorrig.sims.rotor.model.loads import Load, unbalance_loads
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.steady.harmonic_response import load_columns
from rotorrig.sims.rotor.swept.swept_response import swept_columns
from rotorrig.sims.rotor.swept.timeline import TURN, Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows

Complex = NDArray[np.complex128]
Theta = Mapping[str, float]

K, C = (33.0e3, 37.0e3), (14.0, 18.0)  # N/m and N s/m of the spring bearing, x and y
U = 11e-6 * np.exp(0.6j)  # kg m at the disk
SPEEDS = (480.0, 3000.0)  # rpm
RAMP = 240.0  # rpm/s
TURNS = 8  # of a row
SLOW_ROLL = 240.0  # rpm
SIGMA = 0.3e-6  # m, of re or im, as the response states it
DRAWN = 0.8  # of it is drawn: chi2 is 0.64 per degree of freedom, far below the limit of adequacy


def swept_response(
    rig: RigConfig,
    *,
    rng: np.random.Generator | None = None,
    hidden: Sequence[tuple[Effect, Theta]] = (),
    unbalance: complex = U,
    trial: complex = 0j,
    orders: tuple[int, ...] = (1, 2),
    speeds: tuple[float, float] = SPEEDS,
    ramp: float = RAMP,
) -> OrderTrackedResponse:
    """Return what the probes of `rig` show of a rotor on a spring of K and C; `rng` None: without noise.

    `trial` is a known unbalance added to `unbalance` on the disk after the slow roll; `speeds` in rpm, `ramp` in rpm/s.
    """
    pulses = _pulses(speeds, ramp)
    timeline = Timeline(pulses)
    first = np.arange(0, len(pulses) - TURNS, TURNS)
    t = pulses[first + TURNS // 2]
    model = _model(rig, hidden)
    loads = _loads(model, unbalance + trial, hidden), _loads(model, unbalance, hidden, later=False)
    z = np.stack([_vectors(rig, model, timeline, t, loads, order, hidden) for order in orders], axis=-1)
    if rng is not None:
        z = z + DRAWN * SIGMA * (rng.standard_normal(z.shape) + 1j * rng.standard_normal(z.shape))
    return _response(rig, timeline, t, z, orders, trial)


def _pulses(speeds: tuple[float, float], ramp: float) -> NDArray[np.float64]:
    low, high, rate = (figure / RPM for figure in (*speeds, ramp))
    turns = round((high**2 - low**2) / (2 * rate) / TURN)  # whole ones, so that the mirrored pulses are the same turns
    rate = (high**2 - low**2) / (2 * turns * TURN)
    up = (np.sqrt(low**2 + 2 * rate * TURN * np.arange(turns + 1)) - low) / rate
    return np.concatenate([up, 2 * up[-1] - up[-2::-1]])


def _model(rig: RigConfig, hidden: Sequence[tuple[Effect, Theta]]) -> RotorModel:
    model = reduce(with_bearing(assemble(rig), "spring", np.diag(K), np.diag(C)), modes=10)
    for effect, theta in hidden:
        model = effect.change_matrices(model, theta)
    return model


def _loads(
    model: RotorModel, unbalance: complex, hidden: Sequence[tuple[Effect, Theta]], *, later: bool = True
) -> list[Load]:
    (unit,) = unbalance_loads(model, ["disk"])
    own = [load for effect, theta in hidden for load in effect.loads(model, theta) if later or load.since <= 0]
    return [Load(unbalance * unit.pattern, "unbalance"), *own]


def _vectors(
    rig: RigConfig,
    model: RotorModel,
    timeline: Timeline,
    t: NDArray[np.float64],
    loads: tuple[Sequence[Load], Sequence[Load]],
    order: int,
    hidden: Sequence[tuple[Effect, Theta]],
) -> Complex:
    """Return vectors of one order, (row + 1, probe), the slow roll last; `loads` are those of the rows and of that."""
    mine, slow = ([load for load in part if load.order == order] for part in loads)
    z = np.zeros((len(t) + 1, len(rig.probes)), complex)
    if mine:
        rows = tracked_rows(timeline, t=t, revolutions=np.full(len(t), TURNS), window="hann")
        z[:-1] = swept_columns(model, rows, loads=mine, order=order).sum(axis=-1)
        z[-1] = load_columns(model, np.array([SLOW_ROLL / RPM]), slow).sum(axis=-1)
    view = ReadingContext(
        probes=tuple(probe.name for probe in rig.probes),
        angle=np.array([probe.angle for probe in rig.probes]),
        position=np.array([probe.position for probe in rig.probes]),
        order=order,
        omega=np.append(timeline.omega(t), SLOW_ROLL / RPM),
        t=t,
        revolutions=np.full(len(t), float(TURNS)),
        window="hann",
        keyphasor_t=timeline.t,
    )
    for effect, theta in hidden:
        z = effect.change_readings(z, view, theta)
    return z


def _response(
    rig: RigConfig, timeline: Timeline, t: NDArray[np.float64], z: Complex, orders: tuple[int, ...], trial: complex
) -> OrderTrackedResponse:
    rows, probes = len(t), len(rig.probes)
    covariance = np.broadcast_to(SIGMA**2 * np.eye(2 * probes), (rows, len(orders), 2 * probes, 2 * probes))
    added = {"disk": trial} if trial else {}
    return OrderTrackedResponse(
        rig=rig,
        probes=tuple(probe.name for probe in rig.probes),
        orders=tuple(float(order) for order in orders),
        runs=(
            Run(name="up", direction=1, trial_unbalance=added),
            Run(name="down", direction=-1, trial_unbalance=added),
        ),
        run=(t > timeline.t[-1] / 2).astype(np.intp),
        t=t,
        omega=timeline.omega(t),
        alpha=timeline.alpha(t),
        revolutions=np.full(rows, float(TURNS)),
        window="hann",
        z=z[:-1],
        covariance=covariance,
        slow_roll=z[-1],
        slow_roll_covariance=covariance[0],
        slow_roll_omega=SLOW_ROLL / RPM,
        usable=np.ones((rows, probes), dtype=bool),
        reasons=((),) * rows,
        keyphasor_t=timeline.t,
        source=Provenance(config_hash=rig.hash, code_version="", source="swept model"),
    )
