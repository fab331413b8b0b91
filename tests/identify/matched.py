"""Responses made by the rotor model itself, with hidden coefficients and white noise: what a fit must give back."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.provenance import Provenance
from rotorrig.sims.rotor.model.assembly import assemble, scale_properties, with_bearing
from rotorrig.sims.rotor.steady.harmonic_response import probe_response

RPM = np.pi / 30
SLOW_ROLL = 240 * RPM
Pair = tuple[object, object]  # K [N/m] and C [N s/m], (2, 2) each


def sought(rig: RigConfig, **identify: object) -> RigConfig:
    """Return the rig with other keys in [identify], SI, and no bands."""
    table: dict[str, Any] = rig.model_dump(mode="json")
    for derived in ("kxy_bounds", "cxy_bounds"):
        del table["identify"][derived]
    table["identify"] |= {"bands": {}} | identify
    return from_si(table)


def taken_for_exact(rig: RigConfig) -> RigConfig:
    """Return the rig for a model that nothing of the data departs from but noise: as where the model made them."""
    prior = rig.prior.model_copy(
        update={
            "model_error": 0.0,
            "repeatability": 0.0,
            "harmonic_error": 0.0,
            "damping_over_speed": 0.0,
            "mark_radius": math.inf,
        }
    )
    return rig.model_copy(update={"prior": prior})


def with_constant_damping(rig: RigConfig) -> RigConfig:
    """Return the rig for a model whose damping is a constant, as that of the model that made the data."""
    prior = rig.prior.model_copy(update={"damping_over_speed": 0.0})
    return rig.model_copy(update={"prior": prior})


def matched_response(
    rig: RigConfig,
    *,
    bearings: Mapping[str, Pair],
    unbalance: Mapping[str, complex],
    rng: np.random.Generator,
    noise: float = 1e-7,
    youngs_modulus: float = 1.0,
    density: float = 1.0,
    top: float = 3600.0,
) -> OrderTrackedResponse:
    """Return steady 1X vectors from 480 to `top` rpm, noise [m] in re and im, of a rig that hides those values."""
    model = scale_properties(assemble(rig), youngs_modulus=youngs_modulus, density=density)
    for name, (K, C) in bearings.items():
        model = with_bearing(model, name, K, C)
    omega = np.linspace(480, top, 120) * RPM
    clean = probe_response(model, np.append(omega, SLOW_ROLL), unbalance=unbalance)
    z = clean + noise * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape))
    return _response(rig, omega, z, noise)


def _response(
    rig: RigConfig, omega: NDArray[np.float64], z: NDArray[np.complex128], noise: float
) -> OrderTrackedResponse:
    rows, probes = len(omega), len(rig.probes)
    covariance = np.broadcast_to(noise**2 * np.eye(2 * probes), (rows, 1, 2 * probes, 2 * probes))
    unknown = np.full(rows, np.nan)
    return OrderTrackedResponse(
        rig=rig,
        probes=tuple(probe.name for probe in rig.probes),
        orders=(1.0,),
        runs=(Run(name="up", direction=1),),
        run=np.zeros(rows, dtype=np.intp),
        t=unknown,
        omega=omega,
        alpha=unknown,
        revolutions=np.full(rows, 8.0),
        window="hann",
        z=z[:-1, :, None],
        covariance=covariance,
        slow_roll=z[-1, :, None],
        slow_roll_covariance=covariance[0],
        slow_roll_omega=SLOW_ROLL,
        usable=np.ones((rows, probes), dtype=bool),
        reasons=((),) * rows,
        keyphasor_t=np.empty(0),
        source=Provenance(config_hash=rig.hash, code_version="", source="matched"),
    )
