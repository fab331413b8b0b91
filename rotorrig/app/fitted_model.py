"""The rotor as a fit found it, for what is drawn of it: modes and operating deflections."""

import numpy as np

from rotorrig.identify.identification import Fit
from rotorrig.identify.space import Space
from rotorrig.rig.description import RigConfig
from rotorrig.sims.rotor.assembly import RotorModel, assemble, scaled, with_bearing


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
    return scaled(
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
    found = zip(space.planes, space.amounts, space.phases, strict=True)
    return {p: fit.estimate(u.name).value * np.exp(1j * fit.estimate(phase).value) for p, u, phase in found}
