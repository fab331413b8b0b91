"""Rotor motion of a result by its model: 1X deflection of the centreline over speed, and mode shapes.

The model is the one of the fit, without extension, or the nameplate's where there is no fit.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from rotorrig.app.viewer.plots import LINE_LIKE
from rotorrig.app.viewer.result.data import Result
from rotorrig.identify import Fit
from rotorrig.identify.base_model import Space
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.sims.rotor.model import RotorModel, assemble, scale_properties, with_bearing
from rotorrig.sims.rotor.modes import Mode, critical_modes, reduce_if_large, whirl_modes
from rotorrig.sims.rotor.steady import steady_response

MOST_MODES = 3
BEYOND = 1.25  # of the fastest speed: how far critical speeds are looked for


@dataclass(frozen=True, slots=True, kw_only=True)
class RotorMotion:
    """Vectors of x and y at the nodes: the motion is Re(shape e^{j theta})."""

    z: NDArray[np.float64]  # (node,) m from the coupling
    rows: tuple[int, ...]  # of the response
    deflection: NDArray[np.complex128]  # (row, 2, node) m, 1X at these rows
    modes: tuple[Mode, ...]
    model: str  # "fitted" or "nameplate"


@threadpool_limits.wrap(limits=1, user_api="blas")  # many small problems: threads only slow them down
def rotor_motion(result: Result, rows: list[int]) -> RotorMotion:
    """Return the motion at `rows` of the response, and the modes that 1X meets in its range of speeds."""
    model = fitted_model(result.response.rig, result.fit)
    return RotorMotion(
        z=model.z,
        rows=tuple(rows),
        deflection=_deflection(model, result, rows),
        modes=modes_in_range(model, float(result.response.omega.max())),
        model="fitted" if result.fit else "nameplate",
    )


def modes_in_range(model: RotorModel, fastest: float) -> tuple[Mode, ...]:
    """Return the modes that 1X meets up to a little beyond `fastest` [rad/s], or the lowest two there if it meets none.

    Their shapes are at the nodes of `model`.
    """
    small = reduce_if_large(model)
    return critical_modes(small, up_to=BEYOND * fastest)[:MOST_MODES] or whirl_modes(small, fastest, count=2)


def mode_words(mode: Mode, *, rotation: str) -> str:
    """Return what a mode is: "critical speed 2256 rpm, forward, damping 1.9 %"."""
    forward = mode.whirl if rotation == "x-to-y" else -mode.whirl
    way = "along a line" if abs(forward) < LINE_LIKE else "forward" if forward > 0 else "backward"
    at = f"critical speed {mode.omega * RPM:.0f} rpm"
    if not math.isclose(mode.frequency, mode.omega, rel_tol=1e-6):
        at = f"mode of {mode.frequency / math.tau:.1f} Hz at {mode.omega * RPM:.0f} rpm"
    return f"{at}, {way}, damping {100 * mode.damping_ratio:.2g} %"


def _deflection(model: RotorModel, result: Result, rows: list[int]) -> NDArray[np.complex128]:
    """Return x and y of the centreline (row, 2, node) [m], the trial masses of the rows' runs included."""
    response = result.response
    deflection = np.zeros((len(rows), 2, len(model.z)), dtype=complex)
    base = fitted_unbalance(response.rig, result.fit)
    for i, row in enumerate(rows):
        trial = response.runs[response.run[row]].trial_unbalance
        amounts = {name: base.get(name, 0j) + trial.get(name, 0j) for name in {*base, *trial}}
        (q,) = steady_response(model, response.omega[row], unbalance=amounts)
        deflection[i] = model.centreline @ q
    return deflection


def fitted_model(rig: RigConfig, fit: Fit | None) -> RotorModel:
    """Return the model of the nameplate, with the coefficients and factors of `fit` where there is one."""
    model = assemble(rig)
    if fit is None:
        return model
    space = Space.of(rig)
    values = np.array([fit.estimate(name).value for name in space.names])
    for names, K, C in zip(space.groups, *space.matrices(values), strict=True):
        model = with_bearing(model, names, K, C)
    off = {nuisance.name: nuisance.value for nuisance in fit.nuisances}
    for bearing in model.bearings:
        by_axis = np.array([1 + off.get(f"bearing {bearing.name} {axis}", 0.0) for axis in "xy"])
        if (by_axis != 1).any():
            model = with_bearing(model, bearing.name, by_axis[:, None] * bearing.K, bearing.C)
    return scale_properties(
        model,
        youngs_modulus=float(space.shaft_factor("E", values)) * (1 + off.get("E", 0.0)),
        density=float(space.shaft_factor("density", values)),
        disk_mass=1 + off.get("disk mass", 0.0),
    )


def fitted_unbalance(rig: RigConfig, fit: Fit | None) -> dict[str, complex]:
    """Return the unbalance of every plane [kg m] as `fit` found it; without a fit, what the nameplate expects."""
    if fit is None:
        return {d.name: d.unbalance.amount * np.exp(1j * d.unbalance.angle) for d in rig.disks if d.unbalance}
    space = Space.of(rig)
    parameters = zip(space.planes, space.amounts, space.phases, strict=True)
    return {p: fit.estimate(u.name).value * np.exp(1j * fit.estimate(phase).value) for p, u, phase in parameters}
