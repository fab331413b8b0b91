"""Refine a candidate by whitened complex least squares, and say how well the data determine it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from rotorrig.identify.forward import Forward, Structure, UnitResponse
from rotorrig.identify.measurement import Measurement
from rotorrig.identify.parameters import Parameters, Reals
from rotorrig.processing.response import OrderTrackedResponse

Complex = NDArray[np.complex128]

_STEP = (
    1e-6  # finite-difference step of structural parameters, relative: k, E and masses nearly tie, so it must be small
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Polished:
    """A refined candidate: parameters, their covariance and how well it fits."""

    p: Reals  # (parameter,) in the order of `Parameters.names`
    covariance: Reals  # (parameter, parameter), scaled up where the fit is worse than the noise
    chi2: float  # measured figures and priors together
    dof: int


class Problem:
    """The least-squares problem of one band of one response."""

    def __init__(self, response: OrderTrackedResponse, measured: Measurement, box: Reals) -> None:
        """Set up the forward model for the rows measured; `box` (4, 2) bounds the logarithms of k and c (SI)."""
        assert response.rig.identify is not None
        self.parameters = Parameters(response.rig, response.probes)
        self.box = box
        self._measured = measured
        self._disk = response.rig.identify.unbalance
        self._known = _trial_unbalance(response, measured.rows)
        disks = tuple(dict.fromkeys((self._disk, *self._known)))
        self._forward = Forward(response, measured.rows, disks=disks, others=self.parameters.others)
        self._responses: dict[bytes, UnitResponse] = {}
        self.swept = self._forward.swept

    def start(self, theta: Reals) -> Reals:
        """Return a full vector from kxx, kyy, cxx, cyy (SI): unbalance and runout by linear least squares."""
        names = self.parameters
        p = np.zeros(len(names))
        p[names.bearing] = np.clip(np.log(theta[:4]), self.box[:, 0] + 1e-9, self.box[:, 1] - 1e-9)
        columns = np.concatenate([self._linear_columns(p), names.prior_jacobian()[:, names.linear]])
        p[names.linear] = np.linalg.lstsq(columns, -self.residual(p), rcond=None)[0]
        return p

    def solve(self, start: Reals, *, max_steps: int = 25) -> Polished:
        """Refine by trust-region least squares within the box of k and c."""
        found = least_squares(
            self.residual,
            start,
            self.jacobian,
            bounds=self.parameters.bounds(self.box),
            x_scale="jac",
            max_nfev=max_steps,
        )
        chi2 = 2 * float(found.cost)
        dof = self._measured.size + len(self.parameters.priors) - len(start)
        jacobian = np.asarray(found.jac)
        information = jacobian.T @ jacobian
        scale = 1 / np.sqrt(np.diag(information))
        inverse = np.linalg.pinv(information * np.outer(scale, scale), rcond=1e-12, hermitian=True)
        return Polished(
            p=found.x,
            covariance=inverse * np.outer(scale, scale) * max(1.0, chi2 / dof),
            chi2=chi2,
            dof=dof,
        )

    def at_bound(self, p: Reals, i: int) -> bool:
        """Say whether k or c number `i` ended within a per cent of its bound."""
        return bool(np.abs(self.box[i] - p[i]).min() < 0.01)

    def predict(self, p: Reals) -> Complex:
        """Return 1X vectors (row + 1, probe) [m] as they should have been measured, the slow roll last."""
        along, across = self._motion(p)
        gain, cos, sin = self._probes(p)
        runout = p[self.parameters.runout]
        return gain * (cos * along + sin * across) + runout[0::2] + 1j * runout[1::2]

    def residual(self, p: Reals) -> Reals:
        """Return whitened residuals, model less measured, then the priors' [sigma]."""
        off = self._measured.sigmas(self.predict(p) - self._measured.z).ravel()
        return np.concatenate([off, self.parameters.prior_residual(p)])

    def jacobian(self, p: Reals) -> Reals:
        """Return d residual / d p: finite differences for the structure, analytic for the rest."""
        along, across = self._motion(p)
        gain, cos, sin = self._probes(p)
        per_probe = (cos * along + sin * across, gain * (cos * across - sin * along))  # by gain, by angle
        columns = [
            *self._structural_columns(p),
            *(self._whitened(_only(z, i)) for z in per_probe for i in range(z.shape[1])),
        ]
        data = np.concatenate([np.stack(columns, axis=1), self._linear_columns(p)], axis=1)
        return np.concatenate([data, self.parameters.prior_jacobian()])

    def _structural_columns(self, p: Reals) -> Iterator[Reals]:
        base = self.predict(p)
        for i in range(self.parameters.structural.stop):
            moved = p.copy()
            moved[i] += _STEP
            yield self._whitened((self.predict(moved) - base) / _STEP)

    def _linear_columns(self, p: Reals) -> Reals:
        """Return d data residual / d (unbalance, runout)."""
        gain, cos, sin = self._probes(p)
        unit = self._unit(p)
        forced = gain * (cos * unit.along[self._disk] + sin * unit.across[self._disk])
        one = np.ones_like(forced)
        columns = [self._whitened(forced), self._whitened(1j * forced)]
        columns += [self._whitened(_only(part * one, i)) for i in range(one.shape[1]) for part in (1, 1j)]
        return np.stack(columns, axis=1)

    def _motion(self, p: Reals) -> tuple[Complex, Complex]:
        """Return the motion along and across the nominal probe axes for the unbalance in `p` and the trial masses."""
        unit = self._unit(p)
        re, im = p[self.parameters.unbalance]
        along, across = (re + 1j * im) * unit.along[self._disk], (re + 1j * im) * unit.across[self._disk]
        for disk, amounts in self._known.items():
            along = along + amounts[:, None] * unit.along[disk]
            across = across + amounts[:, None] * unit.across[disk]
        return along, across

    def _unit(self, p: Reals) -> UnitResponse:
        structural = p[self.parameters.structural]
        key = structural.tobytes()
        if key not in self._responses:
            if len(self._responses) > 2 * len(structural):
                self._responses.clear()
            kxx, kyy, cxx, cyy = np.exp(p[self.parameters.bearing])
            youngs_modulus, disk_mass, *others = 1 + p[self.parameters.nameplate]
            self._responses[key] = self._forward(
                Structure(
                    kxx=kxx,
                    kyy=kyy,
                    cxx=cxx,
                    cyy=cyy,
                    youngs_modulus=youngs_modulus,
                    disk_mass=disk_mass,
                    others=tuple(others),
                )
            )
        return self._responses[key]

    def _probes(self, p: Reals) -> tuple[Reals, Reals, Reals]:
        """Return gain, and cosine and sine of the angle error, per probe."""
        angle = p[self.parameters.angle]
        return 1 + p[self.parameters.gain], np.cos(angle), np.sin(angle)

    def _whitened(self, change: Complex) -> Reals:
        return self._measured.sigmas(change).ravel()


def _only(z: Complex, probe: int) -> Complex:
    """Return `z` with every probe but one set to zero."""
    kept = np.zeros_like(z)
    kept[:, probe] = z[:, probe]
    return kept


def _trial_unbalance(response: OrderTrackedResponse, rows: NDArray[np.intp]) -> dict[str, Complex]:
    """Return the known added unbalance per disk, (row + 1,) kg m; the slow roll is a run without."""
    disks = dict.fromkeys(disk for run in response.runs for disk in run.trial_unbalance)
    per_run = {d: np.array([run.trial_unbalance.get(d, 0) for run in response.runs], dtype=complex) for d in disks}
    return {disk: np.append(amounts[response.run[rows]], 0) for disk, amounts in per_run.items()}
