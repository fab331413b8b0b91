"""`python -m docs.make_plant_differences [FAULT ...]`: how far an effect, fitted to a simulated fault, is off it.

Some minutes. Each fault is simulated at its usual size on configs/rk4.toml without noise or deviations, at ten steady
speeds; from the order vectors 1X and 2X of all probes those of the healthy rig are taken off. To that difference the
effect that is the right answer is fitted, and with it what any identification fits anyway: modulus, unbalance,
stiffness and damping of the bearing; these to first order where the effect is a force law, which takes long. The model
was fitted to the healthy rig first, so that what stays is the law's. The figure is the root of the mean square of what
stays over that of the difference.
"""

import json
import math
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from benchmarks.parts.blind.names import ANSWERS, answer
from docs.effect_response import Sweep, vectors
from rotorrig.rig.config import RPM, RigConfig, bundled_config, load
from rotorrig.sims.effects import Effect, find
from rotorrig.sims.plant import FaultSpec, Plant
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import load_fault

FIGURES = Path(__file__).with_name("plant-differences.json")
SPEEDS = (700.0, 1000.0, 1110.0, 1400.0, 1800.0, 2080.0, 2190.0, 2280.0, 2450.0, 3000.0)  # rpm
SETTLING = 2.0  # s at each speed: nine time constants of the first mode
TURNS = 30  # measured at each speed
ORDERS = (1, 2)
NOMINAL = np.ones(7)  # modulus, kxx, kyy, cxx, cyy, size of the unbalance, each a factor; its angle [rad] and 1

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def difference(name: str) -> float:
    """Return how far the effect, fitted to the fault at its usual size, is off it: a share of what the fault does."""
    if name == "line_hum":
        return _hum()
    if name == "unbalance_step":
        return _step()
    hidden = FaultSpec(name=name)
    right = answer(_rig(), nameplate(_rig(), faults=[hidden]), hidden)
    want = _simulate(name) - _simulate(None)
    effect = find(_fitted(), right.exact)
    begin = np.array([right.theta.get(p.name, p.starts[0] if p.starts else p.at_zero) for p in effect.parameters])
    low, high, size = (np.array([getattr(p, key) for p in effect.parameters]) for key in ("low", "high", "size"))
    without = _predict(effect, [p.at_zero for p in effect.parameters], NOMINAL)
    follows_law = type(effect).force_laws is not Effect.force_laws  # which takes long: the base to first order, then
    columns = _base_columns() if follows_law else np.zeros((want.size * 2, 0))
    count = len(begin)

    def left(x: Real) -> Real:
        base = NOMINAL if follows_law else x[count:]
        off = _stacked(_predict(effect, (x[:count] * size).tolist(), base) - without - want)
        return (off - columns @ (columns.T @ off)) / np.linalg.norm(want)

    own = np.clip(begin, low + 1e-6 * size, high - 1e-6 * size) / size
    loose = np.ones(0) if follows_law else NOMINAL
    free = np.full(len(loose), np.inf)
    found = least_squares(
        left,
        np.append(own, loose),
        bounds=(np.append(low / size, -free), np.append(high / size, free)),
        diff_step=1e-3,
        x_scale="jac",
        max_nfev=30,
    )
    return float(np.linalg.norm(found.fun))


@cache
def _rig() -> RigConfig:
    return load(bundled_config("rk4"))


@cache
def _simulate(fault: str | None) -> Complex:
    """Return the order vectors (order, speed, probe) [m] of the nameplate's rig, by its keyphasor's edges."""
    rig = _rig()
    plant = Plant(rig, nameplate(rig, faults=[FaultSpec(name=fault)] if fault else []))
    metres = np.array([p.sensitivity for p in rig.probes])
    seen = np.empty((len(ORDERS), len(SPEEDS), len(rig.probes)), complex)
    for i, rpm in enumerate(SPEEDS):
        plant.command(rpm / RPM, 300.0, True)
        plant.advance(plant.t + abs(rpm / RPM - plant.speed) / 300.0 + SETTLING)
        volts = plant.advance(plant.t + (TURNS + 1) * 60.0 / rpm) * np.array(plant.volts_per_count)
        seen[:, i] = _order_vectors(volts[:, : len(metres)], volts[:, -1]) / metres
    return seen


def _order_vectors(volts: Real, keyphasor: Real) -> Complex:
    """Return z (order, channel) over whole turns, x = Re(z e^{j n theta}), theta = 0 at falling edges."""
    level = (keyphasor.min() + keyphasor.max()) / 2
    before = np.flatnonzero((keyphasor[:-1] > level) & (keyphasor[1:] <= level))
    edges = before + (level - keyphasor[before]) / (keyphasor[before + 1] - keyphasor[before])
    theta = math.tau * np.interp(np.arange(len(volts)), edges, np.arange(len(edges)))
    inside = slice(math.ceil(edges[0]), math.ceil(edges[-1]))
    x = volts[inside] - volts[inside].mean(axis=0)
    return np.array([2 * np.mean(x * np.exp(-1j * n * theta[inside])[:, None], axis=0) for n in ORDERS])


@cache
def _fitted() -> RigConfig:
    """Return the nameplate with what any identification fits, fitted to the healthy plant."""
    want = _simulate(None)

    def left(x: Real) -> Real:
        return _stacked(_healthy(_changed(_rig(), x)) - want) / np.linalg.norm(want)

    return _changed(_rig(), least_squares(left, NOMINAL, diff_step=1e-4).x)


def _changed(rig: RigConfig, x: Real) -> RigConfig:
    """Return `rig` with another modulus, kxx, kyy, cxx, cyy of the sought bearing, and unbalance, by x (7,)."""
    *others, sought = rig.bearings
    sides = dict(zip(("kxx", "kyy", "cxx", "cyy"), x[1:5], strict=True))
    other = sought.model_copy(update={k: sought.constant(k) * float(factor) for k, factor in sides.items()})
    shaft = rig.shaft.model_copy(update={"youngs_modulus": rig.shaft.youngs_modulus * float(x[0])})
    disk = rig.disks[0]
    assert disk.unbalance is not None
    heavier = {"amount": disk.unbalance.amount * float(x[5]), "angle": disk.unbalance.angle + float(x[6]) - 1.0}
    disks = (disk.model_copy(update={"unbalance": disk.unbalance.model_copy(update=heavier)}), *rig.disks[1:])
    return rig.model_copy(update={"shaft": shaft, "bearings": (*others, other), "disks": disks})


def _healthy(rig: RigConfig) -> Complex:
    effect = find(rig, "probe_gain, probe 1x")
    seen = vectors(rig, effect, effect.at_zero, _sweep()).up
    return np.array([seen[n] for n in ORDERS])


@cache
def _base_columns() -> Real:
    """Return an orthonormal basis of what an identification of the base does to the vectors, to first order."""
    columns = []
    for step in 1e-3 * np.eye(len(NOMINAL)):
        up, down = (_healthy(_changed(_fitted(), NOMINAL + side * step)) for side in (1, -1))
        columns.append(_stacked(up - down))
    q, _ = np.linalg.qr(np.array(columns).T)
    return q


def _stacked(z: Complex) -> Real:
    return np.concatenate([z.real.ravel(), z.imag.ravel()])


def _predict(effect: Effect, values: list[float], base: Real) -> Complex:
    """Return the order vectors (order, speed, probe) of the fitted model with the effect and a changed base."""
    theta = {p.name: value for p, value in zip(effect.parameters, values, strict=True)}
    seen = vectors(_changed(_fitted(), base), effect, theta, _sweep()).up
    return np.array([seen[n] for n in ORDERS])


@cache
def _sweep() -> Sweep:
    rpm = np.array(SPEEDS)
    omega = np.concatenate([rpm, rpm[::-1], [240.0]]) / RPM
    return Sweep(rpm=rpm, omega=omega, t=10.0 * np.arange(2 * len(rpm)), keyphasor_t=np.arange(0.0, 240.0, 0.02))


def _hum() -> float:
    """Return what one steady tone at 50 Hz, the same in all probes, leaves of a minute at standstill."""
    rig = _rig()
    quiet, loud = (
        Plant(rig, nameplate(rig, faults=faults))
        for faults in ([], [FaultSpec(name="line_hum", parameters={"third": 0.0})])
    )
    probes = len(rig.probes)
    wave = np.concatenate([(loud.advance(t) - quiet.advance(t))[::10, :probes] for t in np.arange(1.0, 61.0)]).astype(
        float
    )
    tone = np.exp(100j * np.pi * np.arange(len(wave)) / 1e3)
    phasor = 2 * np.mean(wave * tone.conj()[:, None])
    return float(np.linalg.norm(wave - (phasor * tone).real[:, None]) / np.linalg.norm(wave))


def _step() -> float:
    """Return what the best step leaves of the change of unbalance, from when it begins until five seconds later."""
    fault = load_fault("unbalance_step")
    leaving: float = fault.LEAVING  # type: ignore[attr-defined]
    t = np.linspace(0.0, 5.0, 5001)
    gone = 1.0 - np.exp(-t / leaving)
    left = [np.linalg.norm(gone - (t >= begin) * gone[t >= begin].mean()) for begin in t[:2000]]
    return float(min(left) / np.linalg.norm(gone))


def main(names: Sequence[str]) -> None:
    """Measure the faults of these names, or all, and keep each figure as it comes."""
    figures = json.loads(FIGURES.read_text(encoding="utf-8")) if FIGURES.exists() else {}
    for name in names or sorted(ANSWERS):
        figures[name] = round(difference(name), 4)
        print(f"{name}: {100 * figures[name]:.1f} %", flush=True)
        FIGURES.write_text(json.dumps(dict(sorted(figures.items())), indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
