"""Tests of the residual for adequacy: global, and focused on stretches of speed.

Both hold a residual, less what may be the model's own error (identify/measurement/model_error.py), against its own
scatter from row to row: noise is independent there, what a model lacks is not.
The global one divides the mean square of all 1X residuals by that of the differences of neighbours, the ratio of von
Neumann (Annals of Mathematical Statistics 12 (1941) 367), whose variance is one over their number. The focused one does
so for stretches of `ADEQUACY.stretch` neighbouring rows of one run, probe and order, as a ratio F to the scatter of
their run, which counts as known from `ADEQUACY.neighbours` stretches on either side, since it is not the same all
through a run: it sees an effect that is loud in a narrow band of speeds and lost in the average. Orders other than 1X
have no source in the linear model but runout, which their slow-roll vector gives. Whatever shakes a rig makes it ring
at its natural frequency, and where such an order passes that, its noise is louder than in the rest of the run; so those
are held against the scatter about the stretch, where that is more: at half orders, of which the linear model has
nothing that could be off, by rows `ADEQUACY.ringing` apart. Of a natural frequency of 9.5 Hz that rang in the noise,
neighbours were correlated by 0.6, as their windows overlap, and rows three apart by 0.1.

p is the probability that a right model has one of them as large, the number of stretches looked at paid for (Sidak,
Journal of the American Statistical Association 62 (1967) 626). How often healthy simulated rigs fail:
benchmarks/healthy.py, docs/adequacy.md.

How the mean position moves (0X, mean_position.py) is described by the same stretches, and decides nothing: no effect
says what it should be, so a model that explains everything else would be called wrong for it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc, fdtri, ndtr

from rotorrig.identify.adequacy.mean_position import MEAN, departures
from rotorrig.identify.adequacy.misfit import Misfit, Stretch, describe_misfit
from rotorrig.identify.adequacy.row_scatter import excess_scatter, local_excess, row_variance
from rotorrig.identify.adequacy.settings import ADEQUACY
from rotorrig.identify.measurement import Measurement, measure
from rotorrig.processing import OrderTrackedResponse

Complex = NDArray[np.complex128]
Predicted = Mapping[int, NDArray[np.complex128]]  # order -> (speed, probe) m as measured, runout included


@dataclass(frozen=True, slots=True, kw_only=True)
class Adequacy:
    """The outcome of both tests and the maps behind them."""

    adequate: bool
    p: float  # that a right model has residuals as large
    scatter_ratio: float  # of 1X over its scatter from row to row: 1 where nothing but noise is left
    worst_sigma: float
    limit: float  # sigma rms of a stretch from which it is loud
    misfits: tuple[Misfit, ...]  # stretches beyond the limit, or the worst one if none is
    centreline: tuple[Misfit, ...] = ()  # of every run the loudest stretch beyond it of the mean position
    residual: NDArray[np.complex128]  # (speed, probe, order) m; NaN where nothing is predicted
    sigmas: NDArray[np.float64]  # (speed, probe, order) |residual| in standard deviations of a component, over sqrt 2
    noise_floor: float  # m


def assess(
    response: OrderTrackedResponse, prediction: Predicted, *, known: Predicted | None = None, used: float = 0.0
) -> Adequacy:
    """Test a fit against a response by its `prediction`; `used`: how many of its 1X values the fit could follow.

    `known` is what is known of the shape of the model's own error, order -> (speed, probe, column) m, one standard
    deviation each.
    """
    residual, sigmas = residual_maps(response, prediction, known)
    every = list(_stretches(response, residual, sigmas))
    stretches = sorted((s for s in every if response.orders[s.order] != MEAN), key=lambda s: -s.sigma)
    limit = focused_limit(len(stretches))
    worst = stretches[0].sigma if stretches else float("nan")
    loud = _merge([s for s in stretches if s.sigma > limit]) or stretches[:1]
    moves = _loudest_of_runs(
        [s for s in every if response.orders[s.order] == MEAN and s.sigma > ADEQUACY.position_limit]
    )
    ratio, sigma = _global_ratio(response, prediction[1], known, used)
    p = _combine([_probability_of_ratio(ratio, sigma), _probability_of_worst(worst, len(stretches))])
    return Adequacy(
        adequate=p >= ADEQUACY.false_alarm_rate,
        p=p,
        scatter_ratio=ratio,
        worst_sigma=worst,
        limit=limit,
        misfits=tuple(describe_misfit(response, prediction, residual, _tight(s, sigmas, limit)) for s in loud),
        centreline=tuple(
            describe_misfit(response, prediction, residual, _tight(s, sigmas, ADEQUACY.position_limit)) for s in moves
        ),
        residual=residual,
        sigmas=sigmas,
        noise_floor=float(np.median(measure(response).sigma[:-1])),
    )


def assess_all(tests: Sequence[Adequacy]) -> Adequacy:
    """Return the outcome for several responses fitted together; the maps have the rows of one after the other."""
    worst = max(tests, key=lambda a: a.worst_sigma)
    p = _combine([test.p for test in tests])
    return replace(
        worst,
        adequate=p >= ADEQUACY.false_alarm_rate,
        p=p,
        scatter_ratio=max(test.scatter_ratio for test in tests),
        misfits=tuple(sorted((m for test in tests for m in test.misfits), key=lambda m: -m.sigma)),
        centreline=tuple(sorted((m for test in tests for m in test.centreline), key=lambda m: -m.sigma)),
        residual=np.concatenate([test.residual for test in tests]),
        sigmas=np.concatenate([test.sigmas for test in tests]),
    )


def focused_limit(stretches: int) -> float:
    """Return the rms of a stretch [sigma] that the worst of so many exceeds by chance at the false-alarm rate."""
    single = 1 - (1 - ADEQUACY.false_alarm_rate / 2) ** (1 / max(stretches, 1))
    freedom, of_scatter = _freedom()
    return float(np.sqrt(fdtri(freedom, of_scatter, 1 - single)))


def _probability_of_worst(worst: float, stretches: int) -> float:
    """Return the probability that the worst of so many is as loud."""
    if not stretches:
        return 1.0
    single = fdtrc(*_freedom(), worst**2)
    return float(-np.expm1(stretches * np.log1p(-min(single, 1 - 1e-16))))


def _freedom() -> tuple[float, float]:
    """Return degrees of freedom of a stretch and of the scatter about it: a difference has two thirds of a value's."""
    values = 2 * ADEQUACY.stretch
    return values, values * (1 + 2 * ADEQUACY.neighbours) * 2 / 3


def _global_ratio(
    response: OrderTrackedResponse, model: Complex, known: Predicted | None, used: float
) -> tuple[float, float]:
    """Return von Neumann's ratio of all 1X residuals, and its standard deviation for noise of any level."""
    measured, off = _compare(response, model, order=1, first=model, known=known)
    return _ratio_to_scatter(measured.where_usable(measured.sigmas(off))[:-1], response.run[measured.rows], used)


def scatter_test(white: NDArray[np.float64], run: NDArray[np.intp], *, used: float) -> tuple[float, float]:
    """Return von Neumann's ratio of residuals (row, value) in sigmas, and the probability of one as large."""
    ratio, sigma = _ratio_to_scatter(white, run, used)
    return ratio, _probability_of_ratio(ratio, sigma)


def _ratio_to_scatter(white: NDArray[np.float64], run: NDArray[np.intp], used: float) -> tuple[float, float]:
    scatter = row_variance(white, run)
    known = white[np.isfinite(white)]
    square = float(np.sum(known**2))
    if not scatter > 0 or not square > 0:
        return 1.0, 1.0
    values = square**2 / (float(np.sum(known**4)) / 3)  # as many as are alike in their noise
    return square / max(len(known) - used, 1.0) / scatter, 1 / np.sqrt(values)


def _probability_of_ratio(ratio: float, sigma: float) -> float:
    """Return the probability that a ratio of that standard deviation is as large."""
    return float(ndtr(-(ratio - 1) / sigma))


def _combine(each: Sequence[float]) -> float:
    """Return the probability that the smallest of so many independent ones is as small."""
    return float(-np.expm1(len(each) * np.log1p(-min(min(each), 1 - 1e-16))))


def residual_maps(
    response: OrderTrackedResponse, prediction: Predicted, known: Predicted | None = None
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
        predicted = prediction.get(int(order)) if order == int(order) else None
        measured, off = _compare(response, predicted, order=order, first=prediction.get(1), known=known)
        usable = measured.usable[:-1]
        own = np.abs(measured.less_error(off)[:-1]) / np.where(usable, measured.sigma[:-1], np.nan)
        residual[measured.rows, :, n] = np.where(usable, off[:-1], np.nan)
        sigmas[measured.rows, :, n] = own / np.sqrt(2)
    return residual, sigmas


def _compare(
    response: OrderTrackedResponse,
    model: Complex | None,
    *,
    order: float,
    first: Complex | None,
    known: Predicted | None = None,
) -> tuple[Measurement, Complex]:
    """Return the measurement of an order and, (row + 1, probe) m, what it has beyond a model (speed, probe).

    Its noise is at least as loud as the residual scatters from row to row, and with 1X and its harmonics comes the
    model's own error; `first` is the model of 1X, `known` as of `assess`. Without a model it should be its
    slow-roll vector.
    """
    measured = measure(response, order=order)
    slow_roll = np.nan_to_num(response.slow_roll[None, :, response.orders.index(order)])
    rows = np.repeat(slow_roll, len(measured.rows), axis=0) if model is None else model[measured.rows]
    off = np.where(measured.usable, measured.z - np.concatenate([rows, measured.z[-1:]]), 0)
    white = measured.where_usable(measured.row_sigmas(off))[:-1]
    measured = measured.louder(excess_scatter(white, response.run[measured.rows]))
    if first is not None and order == int(order) and order >= 1:
        at_rest = np.nan_to_num(response.slow_roll[None, :, response.orders.index(1.0)])
        model_and_rest = np.concatenate([first[measured.rows], 0 * at_rest if measured.compensated else at_rest])
        own = (known or {}).get(int(order))
        if own is not None:
            own = np.nan_to_num(own[np.append(measured.rows, 0)])  # the slow roll has none that counts
        measured = measured.expecting_error(model_and_rest, response, order=int(order), known=own)
    return measured, off


def _stretches(response: OrderTrackedResponse, residual: Complex, sigmas: NDArray[np.float64]) -> Iterator[Stretch]:
    """Yield consecutive groups of rows per run, probe and order, in the order of measurement."""
    white = sigmas * np.exp(1j * np.angle(residual))
    for run in range(len(response.runs)):
        rows = np.flatnonzero((response.run == run) & np.isfinite(sigmas).any(axis=(1, 2)))
        groups = [np.arange(i, min(i + ADEQUACY.stretch, len(rows))) for i in range(0, len(rows), ADEQUACY.stretch)]
        if len(groups) > 1 and len(groups[-1]) < ADEQUACY.stretch // 2:
            groups[-2:] = [np.concatenate(groups[-2:])]
        for group in groups:
            for probe in range(sigmas.shape[1]):
                for order in range(sigmas.shape[2]):
                    own = white[rows, probe, order]
                    if np.isfinite(own[group]).any():
                        louder = _find_excess(own, group, order=response.orders[order])
                        rms = float(np.sqrt(np.nanmean(np.abs(own[group]) ** 2) / louder))
                        yield Stretch(run=run, probe=probe, order=order, rows=rows[group], sigma=rms)


def _find_excess(white: Complex, group: NDArray[np.intp], *, order: float) -> float:
    """Return by how much the noise of an order is louder about a stretch of a run than all through it."""
    if order in (MEAN, 1.0):
        return 1.0
    apart = 1 if order == int(order) else ADEQUACY.ringing
    return local_excess(white, group, around=ADEQUACY.neighbours * ADEQUACY.stretch, apart=apart)


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


def _tight(s: Stretch, sigmas: NDArray[np.float64], limit: float) -> Stretch:
    """Return the stretch from its first loud row to its last: a stretch is coarser than its cause."""
    odd = s.rows[sigmas[s.rows, s.probe, s.order] > limit]
    return replace(s, rows=np.arange(odd[0], odd[-1] + 1)) if len(odd) else s
