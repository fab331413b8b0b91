"""Tests of the residual for adequacy: global, and focused on stretches of speed.

Two tests on the residual of the refined fit. The global one looks at chi2 per degree of freedom of 1X; the focused one
at stretches of `ADEQUACY.stretch` neighbouring rows of one run, probe and order, and takes the worst: it sees an effect
that is loud in a narrow band of speeds and lost in the average. Orders other than 1X have no source in the linear model
but runout, which their slow-roll vector gives.

The sigmas are of single rows and neighbouring residuals are correlated (a scale-factor error is the same in all of
them), so chi2 tables do not give the false-alarm rate. The thresholds come from simulated healthy rigs instead,
nameplate errors included: benchmarks/healthy.py, figures in docs/adequacy.md.

How the mean position moves (0X, mean_position.py) is described by the same stretches, and decides nothing: no effect
says what it should be, so a model that explains everything else would be called wrong for it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.adequacy.mean_position import MEAN, departures
from rotorrig.identify.adequacy.misfit import Misfit, Stretch, describe_misfit
from rotorrig.identify.adequacy.settings import ADEQUACY
from rotorrig.identify.measurement import measure
from rotorrig.processing import OrderTrackedResponse

Predicted = Mapping[int, NDArray[np.complex128]]  # order -> (speed, probe) m as measured, runout included


@dataclass(frozen=True, slots=True, kw_only=True)
class Adequacy:
    """The outcome of both tests and the maps behind them."""

    adequate: bool
    reduced_chi2: float
    worst_sigma: float
    misfits: tuple[Misfit, ...]  # stretches beyond the focused limit, or the worst one if none is
    centreline: tuple[Misfit, ...] = ()  # of every run the loudest stretch beyond it of the mean position
    residual: NDArray[np.complex128]  # (speed, probe, order) m; NaN where nothing is predicted
    sigmas: NDArray[np.float64]  # (speed, probe, order) |residual| in standard deviations of a component, over sqrt 2
    noise_floor: float  # m


def assess(response: OrderTrackedResponse, prediction: Predicted, *, reduced_chi2: float) -> Adequacy:
    """Test a fit against a response by its `prediction` and its chi2 per degree of freedom at 1X."""
    residual, sigmas = residual_maps(response, prediction)
    every = sorted(_stretches(response, sigmas), key=lambda s: -s.sigma)
    stretches = [s for s in every if response.orders[s.order] != MEAN]
    worst = stretches[0].sigma if stretches else float("nan")
    loud = _merge([s for s in stretches if s.sigma > ADEQUACY.focused_limit]) or stretches[:1]
    moves = _loudest_of_runs(
        [s for s in every if response.orders[s.order] == MEAN and s.sigma > ADEQUACY.focused_limit]
    )
    return Adequacy(
        adequate=bool(reduced_chi2 <= ADEQUACY.global_limit and worst <= ADEQUACY.focused_limit),
        reduced_chi2=reduced_chi2,
        worst_sigma=worst,
        misfits=tuple(describe_misfit(response, prediction, residual, _tight(s, sigmas)) for s in loud),
        centreline=tuple(describe_misfit(response, prediction, residual, _tight(s, sigmas)) for s in moves),
        residual=residual,
        sigmas=sigmas,
        noise_floor=float(np.median(measure(response).sigma[:-1])),
    )


def residual_maps(
    response: OrderTrackedResponse, prediction: Predicted
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Return measured less model (speed, probe, order) [m], and the same in sigmas (root mean square 1 if right).

    An order of which nothing is predicted is expected to be its slow-roll vector, the mean position to stay.
    """
    residual = np.full(response.z.shape, np.nan + 0j)
    sigmas = np.full(response.z.shape, np.nan)
    for n, order in enumerate(response.orders):
        if order == MEAN:
            residual[:, :, n], sigmas[:, :, n] = departures(response)
            sigmas[:, :, n] = np.abs(sigmas[:, :, n])
            continue
        measured = measure(response, order=order)
        if order in prediction:
            model = prediction[int(order)][measured.rows]
        else:
            model = np.broadcast_to(np.nan_to_num(response.slow_roll[:, n]), measured.z[:-1].shape)
        off = np.where(measured.usable[:-1], measured.z[:-1] - model, np.nan)
        residual[measured.rows, :, n] = off
        sigmas[measured.rows, :, n] = np.abs(off) / (np.sqrt(2) * measured.sigma[:-1])
    return residual, sigmas


def _stretches(response: OrderTrackedResponse, sigmas: NDArray[np.float64]) -> Iterator[Stretch]:
    """Yield consecutive groups of rows per run, probe and order, in the order of measurement."""
    for run in range(len(response.runs)):
        rows = np.flatnonzero((response.run == run) & np.isfinite(sigmas).any(axis=(1, 2)))
        groups = [rows[i : i + ADEQUACY.stretch] for i in range(0, len(rows), ADEQUACY.stretch)]
        if len(groups) > 1 and len(groups[-1]) < ADEQUACY.stretch // 2:
            groups[-2:] = [np.concatenate(groups[-2:])]
        for group in groups:
            for probe in range(sigmas.shape[1]):
                for order in range(sigmas.shape[2]):
                    values = sigmas[group, probe, order]
                    if np.isfinite(values).any():
                        rms = float(np.sqrt(np.nanmean(values**2)))
                        yield Stretch(run=run, probe=probe, order=order, rows=group, sigma=rms)


def _merge(stretches: list[Stretch]) -> list[Stretch]:
    """Join neighbouring stretches of one run, probe and order; loudest first, its sigma the loudest part's."""
    joined: list[Stretch] = []
    for s in sorted(stretches, key=lambda s: (s.run, s.probe, s.order, s.rows[0])):
        last = joined[-1] if joined else None
        same = last is not None and (last.run, last.probe, last.order) == (s.run, s.probe, s.order)
        if last is not None and same and s.rows[0] - last.rows[-1] <= 1 + ADEQUACY.stretch:
            both = np.concatenate([last.rows, s.rows])
            joined[-1] = Stretch(run=s.run, probe=s.probe, order=s.order, rows=both, sigma=max(last.sigma, s.sigma))
        else:
            joined.append(s)
    return sorted(joined, key=lambda s: -s.sigma)


def _loudest_of_runs(stretches: list[Stretch]) -> list[Stretch]:
    """Return the loudest of every run, joined with its loud neighbours; loudest first."""
    loudest: dict[int, Stretch] = {}
    for s in _merge(stretches):
        loudest.setdefault(s.run, s)
    return list(loudest.values())


def _tight(s: Stretch, sigmas: NDArray[np.float64]) -> Stretch:
    """Return the stretch from its first loud row to its last: a stretch is coarser than its cause."""
    odd = s.rows[sigmas[s.rows, s.probe, s.order] > ADEQUACY.focused_limit]
    return replace(s, rows=np.arange(odd[0], odd[-1] + 1)) if len(odd) else s
