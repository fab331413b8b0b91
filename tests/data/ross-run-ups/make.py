"""Run up the rotor of configs/rk4.toml in ROSS and write its vectors, one row per revolution. Run by ROSS's own Python.

rotor export configs/rk4.toml --ross --out rotor.toml; python make.py rotor.toml FOLDER [CASE...]

The rotor is integrated in time (Newmark) while its speed moves. The spring bearing, its damping and the unbalance
differ from the config (SPRING, UNBALANCE): those are what a fit has to find.
"""

import sys
import time
from pathlib import Path

import numpy as np
import ross as rs
from scipy.interpolate import CubicSpline

RPM = np.pi / 30
STEP = 2e-4  # s; Newmark's mean acceleration lengthens a period of 27 ms by 2e-4
SETTLE = 4.0  # s at the first speed until what the start set off has died down
FIRST, SHOWN, LAST, RATE = 500.0, 600.0, 2800.0, 80.0  # rpm, rpm/s; the table begins at SHOWN
SPRING = {"kxx": 35.4e3, "kyy": 36.3e3, "cxx": 17.0, "cyy": 17.0}  # N/m, N s/m
UNBALANCE = (12e-6, np.radians(40.0))  # kg m
NOISE = 2e-6  # m rms of every sample of a probe
BOW = (40e-6, np.radians(-60.0))  # m at the middle of a half-sine between the bearings
CRACK = {"n": 17, "depth_ratio": 0.25}
PARALLEL = {"mis_type": "parallel", "mis_distance_x": 1e-4, "mis_distance_y": 1e-4, "mis_angle": 0.0}
ANGULAR = {"mis_type": "angular", "mis_distance_x": 0.0, "mis_distance_y": 0.0, "mis_angle": np.radians(5.0)}
COUPLING = {"coupling": "flex", "n": 0, "radial_stiffness": 4e3, "bending_stiffness": 12e3}
PROBES = {"1": 0.2505, "2": 0.3805}  # plane -> m from the coupling
ORDERS = (1, 2, 3)
POINTS = 128  # of a turn
REDUCTION = {"method": "pseudomodal", "num_modes": 60}  # of 192 degrees of freedom


def main() -> None:
    """Write one table per case."""
    rotor, folder = built(sys.argv[1]), Path(sys.argv[2])
    for name in sys.argv[3:] or CASES:
        begun = time.process_time()
        t, speed = history()
        x = CASES[name](rotor, t, speed)
        print(f"{name}: {time.process_time() - begun:.0f} s", flush=True)
        rng = np.random.default_rng(list(CASES).index(name))
        write(
            folder / f"{name}.csv",
            *tracked(t, speed, {k: v + NOISE * rng.standard_normal(len(v)) for k, v in x.items()}),
        )


def built(path: str) -> rs.Rotor:
    """Return the exported rotor, on a spring bearing of its own."""
    rotor = rs.Rotor.load(path)
    *left, spring = sorted(rotor.bearing_elements, key=lambda bearing: bearing.n)
    return rs.Rotor(rotor.shaft_elements, rotor.disk_elements, [*left, rs.BearingElement(n=spring.n, **SPRING)])


def history() -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and speeds [rad/s]: steady, then up evenly."""
    t = np.arange(0.0, SETTLE + (LAST - FIRST) / RATE, STEP)
    return t, RPM * (FIRST + RATE * np.maximum(t - SETTLE, 0.0))


def healthy(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> dict[str, np.ndarray]:
    """Unbalance alone."""
    return seen(rotor, rotor.run_time_response(speed, forces(rotor, t, speed), t, **newmark()))


def bow(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> dict[str, np.ndarray]:
    """Besides, K_s times a bent shape that turns with the shaft."""
    size, angle = BOW
    theta = angle_of(rotor, t, speed)
    stiffness = rotor.K(0) - sum(placed(rotor, bearing) for bearing in rotor.bearing_elements)
    x, y = shape(rotor)
    F = forces(rotor, t, speed)
    F += size * np.outer(np.cos(theta + angle), stiffness @ x) + size * np.outer(np.sin(theta + angle), stiffness @ y)
    return seen(rotor, rotor.run_time_response(speed, F, t, **newmark()))


def parallel(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> dict[str, np.ndarray]:
    """Besides, ROSS's flexible coupling between shafts that are parallel but apart."""
    return seen(rotor, rotor.run_misalignment(**COUPLING, **PARALLEL, **unbalanced(rotor, t, speed), **newmark()))


def angular(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> dict[str, np.ndarray]:
    """Besides, ROSS's flexible coupling between shafts at an angle."""
    return seen(rotor, rotor.run_misalignment(**COUPLING, **ANGULAR, **unbalanced(rotor, t, speed), **newmark()))


def crack(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> dict[str, np.ndarray]:
    """Besides the weight, a crack that breathes once a turn (Mayes)."""
    return seen(
        rotor,
        rotor.run_crack(**CRACK, crack_model="Mayes", **unbalanced(rotor, t, speed), model_reduction=dict(REDUCTION)),
    )


CASES = {case.__name__: case for case in (healthy, bow, parallel, angular, crack)}


def newmark() -> dict:
    return {"method": "newmark", "model_reduction": dict(REDUCTION)}


def unbalanced(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> dict:
    amount, angle = UNBALANCE
    node = [rotor.disk_elements[0].n]
    return {"node": node, "unbalance_magnitude": [amount], "unbalance_phase": [angle], "speed": speed, "t": t}


def forces(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Return the unbalance force (time, dof)."""
    amount, angle = UNBALANCE
    return rotor.unbalance_force_over_time([rotor.disk_elements[0].n], [amount], [angle], speed, t).T


def angle_of(rotor: rs.Rotor, t: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Return the shaft's angle [rad] as ROSS has it."""
    return rotor.unbalance_force_over_time([0], [0.0], [0.0], speed, t, return_all=True)[1]


def placed(rotor: rs.Rotor, bearing: rs.BearingElement) -> np.ndarray:
    """Return a bearing's stiffness among all degrees of freedom."""
    K = np.zeros((rotor.ndof, rotor.ndof))
    dof = list(bearing.dof_global_index.values())
    K[np.ix_(dof, dof)] = bearing.K(0)
    return K


def shape(rotor: rs.Rotor) -> tuple[np.ndarray, np.ndarray]:
    """Return a half-sine of height 1 between the bearings, straight beyond, along x and along y (dof,)."""
    z = np.array(rotor.nodes_pos)
    ends = [rotor.nodes_pos[bearing.n] for bearing in rotor.bearing_elements]
    start, length = min(ends), max(ends) - min(ends)
    s = np.clip((z - start) / length, 0.0, 1.0)
    slope = np.pi / length * np.cos(np.pi * s)
    beyond = (z - start - length * s) * slope
    x, y = np.zeros(rotor.ndof), np.zeros(rotor.ndof)
    x[0::6], x[4::6] = np.sin(np.pi * s) + beyond, slope
    y[1::6], y[3::6] = np.sin(np.pi * s) + beyond, -slope
    return x, y


def seen(rotor: rs.Rotor, result) -> dict[str, np.ndarray]:
    """Return the displacement at every probe (time,) [m]."""
    nodes = {plane: int(np.argmin(np.abs(np.array(rotor.nodes_pos) - z))) for plane, z in PROBES.items()}
    assert all(abs(rotor.nodes_pos[node] - PROBES[plane]) < 1e-9 for plane, node in nodes.items())
    return {plane + axis: result.yout[:, 6 * node + i] for plane, node in nodes.items() for i, axis in enumerate("xy")}


def tracked(t: np.ndarray, speed: np.ndarray, x: dict[str, np.ndarray]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return speeds [rpm] and vectors (turn, order) [um] of every whole turn: z = 2 mean(x e^{-j n theta})."""
    theta = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * STEP)])
    when = CubicSpline(theta, t)
    turns = np.arange(
        np.ceil(np.interp(SHOWN * RPM, speed[t > SETTLE], theta[t > SETTLE]) / (2 * np.pi)), theta[-1] // (2 * np.pi)
    )
    pulses = when(2 * np.pi * np.append(turns, turns[-1] + 1))
    phase = 2 * np.pi * np.arange(POINTS) / POINTS
    at = when(2 * np.pi * turns[:, None] + phase)
    waves = np.exp(-1j * np.outer(phase, ORDERS))
    return 60 / np.diff(pulses), {name: 2e6 / POINTS * CubicSpline(t, signal)(at) @ waves for name, signal in x.items()}


def write(path: Path, rpm: np.ndarray, z: dict[str, np.ndarray]) -> None:
    """Write a table: rpm and, of each probe and order, real and imaginary part in um."""
    header, columns = ["rpm"], [rpm]
    for name, vectors in z.items():
        for i, order in enumerate(ORDERS):
            header += [f"{name} {order}X re", f"{name} {order}X im"]
            columns += [vectors[:, i].real, vectors[:, i].imag]
    formats = ["%.4f", *["%.2f"] * (len(columns) - 1)]
    np.savetxt(path, np.column_stack(columns), fmt=formats, delimiter=",", header=",".join(header), comments="")


if __name__ == "__main__":
    main()
