"""Parameters of a refined fit, in order, and the priors of what the nameplate cannot know exactly.

The unknowns of the [identify] table (unknowns.py, in working coordinates) and the unbalance vectors are what is sought.
Modulus, disk mass, the other bearings, where the parts are, how thick the shaft is, what hubs and bearings add to its
stiffness, probe gain and angle are nuisances with the config's priors, and each probe has its runout. Freed only later,
each of them would be "discovered" in healthy data: +1 % on E alone is a false alarm every time.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.identify.base_model.structure import Structure
from rotorrig.identify.base_model.unknowns import UNITS, Space
from rotorrig.rig.config import RigConfig

Reals = NDArray[np.float64]


class Parameters:
    """Names and slices of the vector `p`, and its priors; made for one rig and the probes of one response."""

    def __init__(self, rig: RigConfig, probes: tuple[str, ...]) -> None:
        """Lay out the vector. Raises ConfigError if the rig has no [identify] table."""
        self.space = Space.of(rig)
        sought = [name for group in self.space.groups for name in group]
        self.others = tuple(b.name for b in rig.bearings if b.name not in sought and not b.rigid)
        self._given = tuple(name for name in ("E", "disk mass") if name not in self.space.also)
        nameplate = (*self._given, *(f"bearing {name} {axis}" for name in self.others for axis in "xy"))
        disks, bearings = ([part.name for part in parts] for parts in (rig.disks, rig.bearings))
        movable = [*(f"disk {d}" for d in disks), *(f"bearing {b}" for b in bearings), *(f"probe {n}" for n in probes)]
        blocks = (
            self.space.names,
            nameplate,
            [f"position {part}" for part in movable],
            ["diameter"],
            [f"hub {d}" for d in disks],
            [f"tilt {b}" for b in bearings],
            [f"gain {name}" for name in probes],
            [f"angle {name}" for name in probes],
            [f"{unbalance.name} {part}" for unbalance in self.space.amounts for part in ("re", "im")],
            [f"runout {name} {part}" for name in probes for part in ("re", "im")],
        )
        self.names = tuple(name for block in blocks for name in block)
        ends = np.cumsum([len(block) for block in blocks])
        starts = [0, *ends[:-1]]
        (
            self.sought,
            self.nameplate,
            self.positions,
            self.diameter,
            self.hubs,
            self.tilts,
            self.gain,
            self.angle,
            self.unbalance,
            self.runout,
        ) = (slice(int(a), int(b)) for a, b in zip(starts, ends, strict=True))
        self.structural = slice(0, self.tilts.stop)  # what the response depends on nonlinearly
        of_shaft = ("E", "position disk ", "position bearing ", "diameter", "hub ")
        self.of_shaft = np.flatnonzero([name.startswith(of_shaft) for name in self.names[: self.structural.stop]])
        self.dampings = np.flatnonzero([u.axes in ("xx", "yy") and u.unit == UNITS["c"] for u in self.space.unknowns])
        self.prior_sigma = self._lay_out_priors(rig, nameplate)
        self.bounding_sigma = self.prior_sigma  # that nuisances are bounded by so many of
        self.priors = np.flatnonzero(np.isfinite(self.prior_sigma))
        self.position_ranges: Reals = np.full(len(movable), np.inf)  # m either way, as far as a model can move them

    def _lay_out_priors(self, rig: RigConfig, nameplate: Sequence[str]) -> Reals:
        """Return the standard deviation of every nuisance (parameter,), infinite for what is sought."""
        prior = rig.prior
        given = {"E": prior.youngs_modulus, "disk mass": prior.disk_mass}
        sigma = np.full(len(self.names), np.inf)
        sigma[self.nameplate] = [given.get(name, prior.bearing) for name in nameplate]
        sigma[self.positions] = prior.position
        sigma[self.diameter] = prior.diameter
        sigma[self.hubs] = prior.hub
        sigma[self.tilts] = [rig.tilt_prior(bearing.name) for bearing in rig.bearings]
        sigma[self.gain] = prior.probe_gain
        sigma[self.angle] = prior.probe_angle
        sigma[self.runout] = prior.runout
        return sigma

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self.names)

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        """Lower and upper bounds of `p`."""
        low, high = np.full(len(self), -np.inf), np.full(len(self), np.inf)
        low[self.sought], high[self.sought] = self.space.working_bounds.T
        low[self.nameplate], high[self.nameplate] = -BASE_MODEL.nameplate_range, BASE_MODEL.nameplate_range
        reach = np.minimum(BASE_MODEL.furthest * self.bounding_sigma[self.positions], self.position_ranges)
        low[self.positions], high[self.positions] = -reach, reach
        reach = np.minimum(BASE_MODEL.furthest * self.bounding_sigma[self.diameter], BASE_MODEL.nameplate_range)
        low[self.diameter], high[self.diameter] = -reach, reach
        low[self.hubs], high[self.hubs] = 0.0, BASE_MODEL.stiffest_hub
        low[self.tilts], high[self.tilts] = 0.0, BASE_MODEL.furthest * self.bounding_sigma[self.tilts]
        return low, high

    def values(self, p: Reals) -> Reals:
        """Return what is sought of `p` in SI, (unknown,)."""
        return self.space.from_working(p[self.sought])

    def structure(self, p: Reals) -> Structure:
        """Return the structural part of `p`."""
        values = self.values(p)
        K, C = self.space.matrices(values)
        given = dict(zip(self._given, 1 + p[self.nameplate], strict=False))
        return Structure(
            K=K,
            C=C,
            youngs_modulus=given.get("E", float(self.space.shaft_factor("E", values))),
            density=float(self.space.shaft_factor("density", values)),
            disk_mass=given["disk mass"],
            others=tuple(1 + p[self.nameplate][len(given) :]),
            positions=tuple(p[self.positions]),
            diameter=float(p[self.diameter][0]),
            hubs=tuple(p[self.hubs]),
            tilts=tuple(p[self.tilts]),
        )

    def structure_derivatives(self, p: Reals) -> list[Structure]:
        """Return the derivatives of that by every structural parameter."""
        count, sought = self.structural.stop, len(self.space)
        change = np.zeros((count, sought))
        change[:sought] = np.diag(self.space.slopes(self.values(p)))
        K, C = self.space.matrices(change)
        factors = {name: np.zeros(count) for name in ("E", "density", "disk mass")}
        for name in self.space.also:
            factors[name] = self.space.shaft_factor(name, change)
        for i, name in enumerate(self._given):
            factors[name][sought + i] = 1.0
        own = np.eye(count)
        others = own[:, sought + len(self._given) : self.nameplate.stop]
        return [
            Structure(
                K=K[i],
                C=C[i],
                youngs_modulus=factors["E"][i],
                density=factors["density"][i],
                disk_mass=factors["disk mass"][i],
                others=tuple(others[i]),
                positions=tuple(own[i, self.positions]),
                diameter=float(own[i, self.diameter][0]),
                hubs=tuple(own[i, self.hubs]),
                tilts=tuple(own[i, self.tilts]),
            )
            for i in range(count)
        ]

    def amounts(self, p: Reals) -> dict[str, complex]:
        """Return the unbalance sought on every plane [kg m]."""
        parts = p[self.unbalance].reshape(-1, 2)
        return {plane: complex(*part) for plane, part in zip(self.space.planes, parts, strict=True)}
