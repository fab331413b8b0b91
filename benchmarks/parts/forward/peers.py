"""The same unbalance response by other means, for benchmarks/forward.py: dense solves here, ROSS in its environment."""

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.rotor.model import Matrices, RotorModel, matrices, unbalance_direction, with_bearing

Complex = NDArray[np.complex128]
Response = Callable[[float, float, float, float, float], Complex]  # kxx, kyy, cxx, cyy, u -> (speed, probe) m

ROSS_PROGRAM = Path(__file__).with_name("ross_forward.py")
ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "NUMBA")}


def dense(model: RotorModel, omega: NDArray[np.float64], *, bearings: tuple[str, ...], disk: str) -> Response:
    """Return the response by one batched complex solve of all coordinates, (speed, dof, dof)."""
    (M, C, G, K), rows, force = _parts(model, bearings, disk)
    O = omega[:, None, None]  # noqa: E741
    rest = K - O**2 * M + 1j * O * (C + O * G)

    def response(kxx: float, kyy: float, cxx: float, cyy: float, u: float) -> Complex:
        stiffness, damping = _bearing(rows, kxx, kyy), _bearing(rows, cxx, cyy)
        Z = rest + stiffness + 1j * O * damping
        loads = omega[:, None] ** 2 * (u * force)
        return np.linalg.solve(Z, loads[..., None])[..., 0] @ model.probes.T

    return response


def real_form(model: RotorModel, omega: NDArray[np.float64], *, bearings: tuple[str, ...], disk: str) -> Response:
    """Return the response by eq. (11), real and twice as large, its signs of Omega C put right; q_C - j q_S."""
    (M, C, G, K), rows, force = _parts(model, bearings, disk)
    O = omega[:, None, None]  # noqa: E741
    stiff, damped = K - O**2 * M, O * (C + O * G)
    n = model.dof

    def response(kxx: float, kyy: float, cxx: float, cyy: float, u: float) -> Complex:
        A = np.empty((len(omega), 2 * n, 2 * n))
        A[:, :n, :n] = A[:, n:, n:] = stiff + _bearing(rows, kxx, kyy)
        A[:, :n, n:] = damped + O * _bearing(rows, cxx, cyy)
        A[:, n:, :n] = -A[:, :n, n:]
        loads = omega[:, None] ** 2 * (u * np.concatenate([force.real, -force.imag]))
        q = np.linalg.solve(A, loads[..., None])[..., 0]
        return (q[:, :n] - 1j * q[:, n:]) @ model.probes.T

    return response


def ross(python: Path, cases: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Run ROSS on the cases in its own environment, one thread; return its versions, times and responses."""
    found = subprocess.run(
        [python, ROSS_PROGRAM],
        input=json.dumps(cases),
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | ONE_THREAD,
    )
    if found.returncode:
        raise SystemExit(f"{ROSS_PROGRAM.name} under {python} failed: {found.stderr.strip().splitlines()[-1]}")
    return json.loads(found.stdout.splitlines()[-1])


def ross_case(rig: RigConfig, model: RotorModel, omega: NDArray[np.float64], *, disk: str, u: float) -> dict[str, Any]:
    """Return the rotor as numbers for ross_forward.py: same mesh, same inertias, same speeds."""

    def node(position: float) -> int:
        return int(np.argmin(np.abs(model.z - position)))

    shaft = rig.shaft
    return {
        "lengths": np.diff(model.z).tolist(),
        "outer": shaft.diameter,
        "inner": shaft.inner_diameter,
        "material": {"rho": shaft.density, "E": shaft.youngs_modulus, "Poisson": shaft.poisson_ratio},
        "disks": [
            {"n": node(d.position), "m": d.mass, "Id": d.transverse_inertia, "Ip": d.polar_inertia} for d in rig.disks
        ],
        "bearings": [
            {"n": node(b.position)} | {name: b.constant(name) for name in ("kxx", "kyy", "cxx", "cyy")}
            for b in rig.bearings
        ],
        "unbalance": {"node": node(rig.disk(disk).position), "amount": u},
        "omega": omega.tolist(),
        "probes": [[node(p.position), p.angle] for p in rig.probes],
    }


def _parts(model: RotorModel, bearings: tuple[str, ...], disk: str) -> tuple[Matrices, NDArray[np.float64], Complex]:
    """Return the model without `bearings`, their rows (2, bearing, dof) and the force per Omega^2 and kg m."""
    bare = with_bearing(model, bearings, np.zeros((2, 2)), np.zeros((2, 2)))
    rows = np.stack([model.bearing(name).rows for name in bearings], axis=1)
    return matrices(bare), rows, unbalance_direction(model.disk(disk), model.rotation)


def _bearing(rows: NDArray[np.float64], along_x: float, along_y: float) -> NDArray[np.float64]:
    return along_x * (rows[0].T @ rows[0]) + along_y * (rows[1].T @ rows[1])
