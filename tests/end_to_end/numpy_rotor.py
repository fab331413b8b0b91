"""A rotor in plain numpy, and its Bode tables as another group's program would write them: nothing of rotorrig in it.

The numbers are those of configs/rk4.toml, typed again. Timoshenko elements with a consistent mass, slopes dx/dz and
dy/dz as coordinates, and a dense solution at every speed. The table's own convention is x = A cos(theta - lag).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

RPM = np.pi / 30
MODULUS, DENSITY, POISSON, DIAMETER = 208.11e9, 7801.0, 0.3, 0.010
DISK = 0.2805  # m, as the planes and bearings
PLANES = {"1": 0.2505, "2": 0.3805}
BEARINGS = {0.065: (2e6, 2e6, 0.0), 0.080: (2e6, 2e6, 0.0), 0.481: (33.9e3, 34.6e3, 15.0)}
NODES = np.unique([0, 0.03, *BEARINGS, 0.12, 0.16, 0.205, *PLANES.values(), DISK, 0.33, 0.43, 0.52, 0.56])


@dataclass(frozen=True)
class Hidden:
    """What the table's rotor has that its description does not say; nothing by default."""

    unbalance: complex = 15e-6  # kg m, on the disk
    bow: complex = 0.0  # m, at the disk
    runout: Mapping[str, complex] = field(default_factory=dict)  # m, plane -> forward circular vector
    delay: Mapping[str, float] = field(default_factory=dict)  # s, probe -> it is late by
    skew: float = 0.0  # N/m, kxy = -kyx at the spring bearing
    gain: Mapping[str, float] = field(default_factory=dict)  # probe -> factor


@dataclass(frozen=True)
class Matrices:
    """Of 4 coordinates x, y, dx/dz, dy/dz a node."""

    M: np.ndarray
    C: np.ndarray
    G: np.ndarray
    K: np.ndarray
    shaft: np.ndarray  # stiffness of the shaft alone


def node(position: float) -> int:
    return int(np.argmin(np.abs(NODES - position)))


def matrices(hidden: Hidden = Hidden()) -> Matrices:
    n = 4 * len(NODES)
    M, C, G, shaft = (np.zeros((n, n)) for _ in range(4))
    area, inertia = np.pi * DIAMETER**2 / 4, np.pi * DIAMETER**4 / 64
    shear = MODULUS / (2 * (1 + POISSON)) * area * 6 * (1 + POISSON) / (7 + 6 * POISSON)
    for i, L in enumerate(np.diff(NODES)):
        phi = 12 * MODULUS * inertia / (shear * L**2)
        k = np.array(
            [
                [12, 6 * L, -12, 6 * L],
                [6 * L, (4 + phi) * L**2, -6 * L, (2 - phi) * L**2],
                [-12, -6 * L, 12, -6 * L],
                [6 * L, (2 - phi) * L**2, -6 * L, (4 + phi) * L**2],
            ]
        )
        m = np.array(
            [
                [156, 22 * L, 54, -13 * L],
                [22 * L, 4 * L**2, 13 * L, -3 * L**2],
                [54, 13 * L, 156, -22 * L],
                [-13 * L, -3 * L**2, -22 * L, 4 * L**2],
            ]
        )
        for plane in (0, 1):
            at = np.ix_(*[4 * i + plane + np.array([0, 2, 4, 6])] * 2)
            shaft[at] += MODULUS * inertia / (L**3 * (1 + phi)) * k
            M[at] += DENSITY * area * L / 420 * m
    d = 4 * node(DISK)
    M[range(d, d + 4), range(d, d + 4)] += [0.809, 0.809, 327.60e-6, 327.60e-6]
    G[d + 2, d + 3], G[d + 3, d + 2] = 568.46e-6, -568.46e-6
    K = shaft.copy()
    for position, (kxx, kyy, c) in BEARINGS.items():
        b = 4 * node(position)
        K[b, b] += kxx
        K[b + 1, b + 1] += kyy
        C[b, b] += c
        C[b + 1, b + 1] += c
    b = 4 * node(0.481)
    K[b, b + 1] += hidden.skew
    K[b + 1, b] -= hidden.skew
    return Matrices(M, C, G, K, shaft)


def bent(hidden: Hidden) -> np.ndarray:
    """Return the bow's shape (coordinate,), forward circular: half a sine over the span between the bearings."""
    shape = np.zeros(4 * len(NODES), complex)
    span = np.clip((NODES - 0.0725) / (0.481 - 0.0725), 0, 1)
    peak = np.sin(np.pi * (DISK - 0.0725) / (0.481 - 0.0725))
    x, slope = np.sin(np.pi * span) / peak, np.gradient(np.sin(np.pi * span) / peak, NODES)
    shape[0::4], shape[1::4], shape[2::4], shape[3::4] = x, -1j * x, slope, -1j * slope
    return hidden.bow * shape


def motion(rpm: np.ndarray, hidden: Hidden, *, trial: complex = 0.0) -> np.ndarray:
    """Return the steady motion at 1X (speed, coordinate) m: x = Re(z exp(j theta)), theta = 0 at the keyphasor mark."""
    own = matrices(hidden)
    d = 4 * node(DISK)
    constant = own.shaft @ bent(hidden)
    z = np.empty((len(rpm), len(own.M)), complex)
    for i, w in enumerate(rpm * RPM):
        force = constant.copy()
        force[d] += w**2 * (hidden.unbalance + trial)
        force[d + 1] += -1j * w**2 * (hidden.unbalance + trial)
        z[i] = np.linalg.solve(own.K + 1j * w * (own.C + w * own.G) - w**2 * own.M, force)
    return z


def vectors(
    rpm: np.ndarray,
    hidden: Hidden = Hidden(),
    *,
    planes: Sequence[str] = ("1",),
    trial: complex = 0.0,
) -> dict[str, np.ndarray]:
    """Return what the probes of the planes read, "1x" -> (speed,) m."""
    z = motion(rpm, hidden, trial=trial)
    read = {}
    for plane in planes:
        for axis, turned in (("x", 1), ("y", -1j)):
            name, at = plane + axis, 4 * node(PLANES[plane]) + "xy".index(axis)
            late = np.exp(-1j * rpm * RPM * hidden.delay.get(name, 0.0))
            seen = z[:, at] * late * hidden.gain.get(name, 1.0)
            read[name] = seen + turned * hidden.runout.get(plane, 0.0)
    return read


def with_noise(read: Mapping[str, np.ndarray], rng: np.random.Generator, *, sigma: float = 0.3e-6) -> dict:
    return {n: z + sigma * (rng.standard_normal(len(z)) + 1j * rng.standard_normal(len(z))) for n, z in read.items()}


def table(runs: Mapping[str, tuple[np.ndarray, Mapping[str, np.ndarray]]]) -> str:
    """Return a CSV of runs, name -> (rpm, vectors): amplitudes in um 0-peak, phase lags in degrees 0 to 360."""
    names = list(next(iter(runs.values()))[1])
    lines = [",".join(["run", "rpm", *(f"{n} {what}" for n in names for what in ("um", "lag"))])]
    for run, (rpm, read) in runs.items():
        for i, speed in enumerate(rpm):
            cells = [run, f"{speed:.2f}"]
            for n in names:
                cells += [f"{abs(read[n][i]) * 1e6:.4f}", f"{np.degrees(-np.angle(read[n][i])) % 360:.4f}"]
            lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def mapping(
    runs: Mapping[str, str], *, planes: Sequence[str] = ("1",), uncertainty: str | None = "0.3 um", top: str = ""
) -> str:
    """Return the mapping of such a table; `runs` are name -> the other lines of the run, its direction among them."""
    text = f'run_column = "run"\n{top}\n[speed]\ncolumn = "rpm"\nunit = "1 rpm"\n'
    for name in [plane + axis for plane in planes for axis in "xy"]:
        text += f'[[vectors]]\nprobe = "{name}"\namplitude = "{name} um"\nphase = "{name} lag"\nunit = "1 um"\n'
        text += 'phase_is = "lag"\nphase_unit = "1 deg"\n'
    for name, lines in runs.items():
        text += f'[[runs]]\nname = "{name}"\nvalue = "{name}"\n{lines}\n'
    return text + (f'[uncertainty]\nabsolute = "{uncertainty}"\n' if uncertainty else "")


def write(folder: Path, csv: str, toml: str, *, name: str = "table") -> tuple[Path, Path]:
    """Write both and return their paths."""
    (folder / f"{name}.csv").write_text(csv)
    (folder / f"{name}.toml").write_text(toml)
    return folder / f"{name}.csv", folder / f"{name}.toml"


def ramped(
    start: float, end: float, ramp: float, *, turns: int, planes: Sequence[str] = ("1",), step: float = 1e-4
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return speeds [rpm] and vectors of a run from `start` to `end` [rpm] at `ramp` [rpm/s], `turns` to a row.

    The motion is integrated in time (Newmark, average acceleration, the lowest 10 modes of the rotor at rest), begun at
    rest well before the first row, and a row is 2 mean(x exp(-j theta)) over its turns under Hann's window (an even one
    would let a changing amplitude leak from -1X): no envelope, no steady state.
    """
    own, hidden = matrices(), Hidden()
    values, modes = np.linalg.eig(np.linalg.solve(own.M, own.K))
    modes = modes[:, np.argsort(values.real)[:10]].real
    M, C, G, K = (modes.T @ A @ modes for A in (own.M, own.C, own.G, own.K))
    alpha = np.sign(end - start) * ramp * RPM
    lead = 0.3 * start / ramp  # s: a third of the first speed before it, where nothing resonates
    t = np.arange(0, lead + abs(end - start) / ramp + 8 * turns * 60 / min(start, end), step)
    speed = start * RPM + alpha * (t - lead)
    speed = speed[speed > 0.3 * min(start, end) * RPM]
    t = t[: len(speed)]
    theta = np.concatenate([[0], np.cumsum((speed[1:] + speed[:-1]) / 2 * step)])
    d = 4 * node(DISK)
    push = hidden.unbalance * (speed**2 - 1j * alpha) * np.exp(1j * theta)
    force = np.outer(push.real, modes[d]) + np.outer(push.imag, modes[d + 1])
    x = v = np.zeros(len(K))
    a = np.linalg.solve(M, force[0])
    path = np.empty((len(t), len(K)))
    for i in range(len(t)):
        D = C + speed[i] * G
        guess, rate = x + step * v + step**2 / 4 * a, v + step / 2 * a
        a = np.linalg.solve(M + step / 2 * D + step**2 / 4 * K, force[i] - K @ guess - D @ rate)
        x, v = guess + step**2 / 4 * a, rate + step / 2 * a
        path[i] = x
    first = np.interp(lead, t, theta)
    count = int((theta[-1] - first) / (2 * np.pi * turns)) - 1
    whole = 2 * np.pi * np.ceil(first / (2 * np.pi))
    middle = whole + 2 * np.pi * turns * (np.arange(count) + 0.5)
    at = whole + 2 * np.pi * turns * np.arange(count)[:, None] + 2 * np.pi * (np.arange(64 * turns) + 0.5) / 64
    weight = 1 - np.cos(2 * np.pi * (np.arange(64 * turns) + 0.5) / (64 * turns))
    rpm = np.interp(middle, theta, speed) / RPM
    inside = (rpm >= min(start, end)) & (rpm <= max(start, end))
    read = {}
    for plane in planes:
        for axis in "xy":
            seen = path @ modes[4 * node(PLANES[plane]) + "xy".index(axis)]
            read[plane + axis] = (2 * weight * np.interp(at, theta, seen) * np.exp(-1j * at)).mean(axis=1)[inside]
    return rpm[inside], read
