"""Parametric bootstrap: simulate the measurement again and again, refit, and see how the estimates scatter.

A draw is of the fitted rig, except for the nuisances, which are drawn from their priors. Noise of the stated covariance
is added, enlarged where the fit is worse than it. Neither need chi2 be quadratic nor the estimates off their bounds;
that the model is right is taken for granted. Efron and Tibshirani, An Introduction to the Bootstrap (1993), ch. 6, 13.
"""

import multiprocessing
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.identification import Estimate, Fit
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty.quantities import quantities
from rotorrig.identify.uncertainty.settings import UNCERTAINTY

Complex = NDArray[np.complex128]

Progress = Callable[[int], None]  # is told how many draws are done
Refit = Callable[[ExtendedProblem, Reals], Solution]  # of a drawn problem, given the parameters it was drawn with


@dataclass(frozen=True, slots=True, kw_only=True)
class Resampling:
    """Options of a bootstrap."""

    draws: int
    workers: int = 1
    search: bool = False  # refit by the whole search
    progress: Progress = lambda done: None


@dataclass(frozen=True, slots=True, kw_only=True)
class Bootstrap:
    """The refitted draws, fewer than asked for if they were interrupted."""

    names: tuple[str, ...]  # of the estimates
    draws: Reals  # (draw, estimate) SI; phases within half a turn of the estimate
    asked: int
    seed: int

    def interval(self, name: str, *, level: float = UNCERTAINTY.level) -> tuple[float, float] | None:
        """Return the percentile interval of an estimate [SI], None of fewer than `fewest_draws` draws.

        One more draw would fall into it with probability `level`.
        """
        if len(self.draws) < UNCERTAINTY.fewest_draws:
            return None
        tail = (1 - level) / 2
        low, high = np.quantile(self.draws[:, self.names.index(name)], [tail, 1 - tail], method="weibull")
        return float(low), float(high)


def with_bootstrap_intervals(
    fit: Fit, problem: ExtendedProblem, best: Solution, resampling: Resampling, *, seed: int, search: Refit
) -> Fit:
    """Return the fit with the intervals of a bootstrap; `search` refits by the whole search, if that is wanted."""
    resampled = bootstrap(
        problem,
        best,
        draws=resampling.draws,
        seed=seed,
        refit=search if resampling.search else refit_locally,
        workers=resampling.workers,
        progress=resampling.progress,
    )
    return replace(
        fit,
        estimates=tuple(_with_bootstrap_interval(estimate, resampled) for estimate in fit.estimates),
        words=(*fit.words, *_words(resampled)),
    )


def refit_locally(problem: ExtendedProblem, start: Reals) -> Solution:
    """Refit a draw from the parameters it was drawn with: no other minimum is looked for."""
    return problem.solve(start)


def bootstrap(
    problem: ExtendedProblem,
    best: Solution,
    *,
    draws: int,
    seed: int = 0,
    refit: Refit = refit_locally,
    workers: int = 1,
    progress: Progress = lambda done: None,
) -> Bootstrap:
    """Return the estimates of `draws` simulated measurements. Ctrl-C ends it and keeps the draws done.

    A draw depends on `seed` and its number alone, not on `workers`, the processes; with several, `refit` has to stand
    in a module.
    """
    job = _Job(problem, best, seed, refit)
    done: dict[int, Reals] = {}
    with suppress(KeyboardInterrupt):
        for i, values in _run_in_processes(job, draws, workers) if workers > 1 else _run_one_by_one(job, draws):
            done[i] = values
            progress(len(done))
    names = tuple(quantity.name for quantity in quantities(problem.parameters.base, best.p))
    values = np.reshape([done[i] for i in sorted(done)], (len(done), len(names)))
    return Bootstrap(names=names, draws=values, asked=draws, seed=seed)


def simulate_draw(
    problem: ExtendedProblem, best: Solution, *, rng: np.random.Generator
) -> tuple[Reals, list[dict[int, Complex]]]:
    """Return parameters and the vectors they might have given: per recording order -> (row + 1, probe) [m]."""
    parameters = problem.parameters
    p = best.p.copy()
    scatter = parameters.prior_sigma[parameters.priors] * rng.standard_normal(len(parameters.priors))
    p[parameters.priors] = parameters.start(np.zeros(0))[parameters.priors] + scatter
    p = np.clip(p, *parameters.bounds)
    excess = np.sqrt(max(1.0, best.chi2 / best.dof))
    drawn = [
        {order: z + excess * recording.measured[order].noise(rng) for order, z in predicted.items()}
        for recording, predicted in zip(problem.recordings, problem.model.predict(p), strict=True)
    ]
    return p, drawn


def _with_bootstrap_interval(estimate: Estimate, bootstrap: Bootstrap) -> Estimate:
    interval = bootstrap.interval(estimate.name)
    if interval is None or estimate.interval is None:
        return estimate
    return replace(estimate, interval=interval, interval_by="bootstrap")


def _words(bootstrap: Bootstrap) -> Iterator[str]:
    done = len(bootstrap.draws)
    if done < bootstrap.asked:
        yield f"The bootstrap was interrupted after {done} of {bootstrap.asked} draws."
    fewest = UNCERTAINTY.fewest_draws
    if done < fewest:
        yield f"A bootstrap of {done} draws gives no 95 % interval, want at least {fewest}: the others stand."


@dataclass(frozen=True)
class _Job:
    """Task of a worker: called with the number of a draw, it returns the estimates (estimate,)."""

    problem: ExtendedProblem
    best: Solution
    seed: int
    refit: Refit

    def __call__(self, i: int) -> Reals:
        rng = np.random.default_rng([self.seed, i])
        with threadpool_limits(1, user_api="blas"):
            start, z = simulate_draw(self.problem, self.best, rng=rng)
            p = self.refit(self.problem.of(z), start).p
        return np.array([q.si(q.read(p)) for q in quantities(self.problem.parameters.base, self.best.p)])


def _run_one_by_one(job: _Job, draws: int) -> Iterator[tuple[int, Reals]]:
    for i in range(draws):
        yield i, job(i)


def _run_in_processes(job: _Job, draws: int, workers: int) -> Iterator[tuple[int, Reals]]:
    """Yield the draws as they come; Ctrl-C reaches this process alone."""
    pool = ProcessPoolExecutor(
        min(workers, draws),
        mp_context=multiprocessing.get_context("spawn"),  # a fork would copy locks that threads of this process hold
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_IGN),
    )
    try:
        numbers = {pool.submit(job, i): i for i in range(draws)}
        for future in as_completed(numbers):
            yield numbers[future], future.result()
    finally:
        pool.shutdown(cancel_futures=True)
