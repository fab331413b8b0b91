"""One adapter per method: CHEA's two profiles, an elitist genetic algorithm without clustering, and today's peers.

A method gets the counted function, the bounds (dim, 2) and a generator, and ends by itself; where it has no natural end
in two dimensions it has a budget. Settings are the method's usual ones, but for those named in `Method.settings`.
"""

import warnings
from collections.abc import Callable, Generator
from dataclasses import dataclass
from importlib import metadata
from typing import Any, Literal

import numpy as np
from scipy import optimize
from scipy.optimize import Bounds
from scipy.stats import qmc

from benchmarks.parts.chea.counting import BudgetSpent, Counted
from benchmarks.parts.chea.functions import Array
from rotorrig.identify.chea import SEED, Profile, chea
from rotorrig.identify.chea.chapter.genetic import Colony

UNIMPROVED = 10  # generations after which the elitist genetic algorithm ends
STARTS = 32


@dataclass(frozen=True)
class Found:
    """What a method returns: its best point (dim,) and the minima it lists (n, dim), the best one among them."""

    x: Array
    listed: Array

    @classmethod
    def one(cls, x: Array) -> "Found":
        """Return the finding of a method that ends at one point: it lists that."""
        return cls(x, x[None])


@dataclass(frozen=True, kw_only=True)
class Method:
    """A method of the tables."""

    name: str
    solve: Callable[[Counted, Array, np.random.Generator], Found]
    settings: str
    budget: int | None = None  # calls in two dimensions, for what has no natural end
    max_dim: int | None = None  # beyond it a run takes minutes, or more memory than there is
    package: str = "scipy"

    @property
    def version(self) -> str:
        """The version of its package; empty where that is not installed."""
        try:
            return metadata.version(self.package)
        except metadata.PackageNotFoundError:
            return ""

    def can(self, dim: int) -> bool:
        """Whether it is installed, and able to do this many dimensions."""
        return bool(self.version) and (self.max_dim is None or dim <= self.max_dim)

    def run(self, fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
        """Solve; at the end of the budget, return the best point until then."""
        try:
            return self.solve(fun, bounds, rng)
        except BudgetSpent:
            return Found.one(fun.best_x)


def hybrid(fun: Counted, bounds: Array, rng: np.random.Generator, *, profile: Profile) -> Found:
    """Run CHEA."""
    found = chea(fun.batch, bounds, rng=rng, profile=profile, vectorized=True, max_nfev=fun.budget or 10_000)
    return Found(found.x, np.vstack([found.x, found.xl]))


def elitist_ga(fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
    """Run the seed profile's genetic algorithm alone, to its end, and a descent from its best individual."""
    low, width = bounds[:, 0], np.ptp(bounds, axis=1)

    def answer(part: Generator[Array, Array, None]) -> None:
        points = next(part, None)
        while points is not None:
            try:
                points = part.send(fun.batch(low + points * width))
            except StopIteration:
                return

    colony = Colony(np.stack([np.zeros(len(low)), np.ones(len(low))]), rng=rng, settings=SEED)
    answer(colony.create_founders())
    best, since = fun.best_fun, 0
    while since < UNIMPROVED:
        answer(colony.advance())
        since = since + 1 if fun.best_fun == best else 0
        best = fun.best_fun
    return Found.one(descend(fun, fun.best_x, bounds))


def multistart(fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
    """Descend from every point of a scrambled Sobol sequence; list the ends, as far as the budget goes."""
    starts = bounds[:, 0] + qmc.Sobol(len(bounds), rng=rng).random(STARTS) * np.ptp(bounds, axis=1)
    ends: list[Array] = []
    for start in starts:
        try:
            ends.append(descend(fun, start, bounds))
        except BudgetSpent:
            break
    return Found(fun.best_x, np.vstack([fun.best_x, *ends]))


def descend(fun: Counted, start: Array, bounds: Array) -> Array:
    """Return the end (dim,) of SLSQP, its gradient by forward differences, to 1e-10 in the function."""
    return optimize.minimize(fun, start, method="SLSQP", bounds=Bounds(*bounds.T), options={"ftol": 1e-10}).x


def shgo(fun: Counted, bounds: Array, rng: np.random.Generator, *, n: int) -> Found:
    """Run simplicial homology on a scrambled Sobol sequence; scipy's own sequence is the same in every run."""
    sobol = qmc.Sobol(len(bounds), rng=rng)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of scipy, where no minimum is found
        found = optimize.shgo(fun, Bounds(*bounds.T), n=n, sampling_method=lambda n, dim: sobol.random(n))
    if found.x is None or not len(found.xl):
        return Found.one(fun.best_x)
    return Found(found.x, np.atleast_2d(found.xl))


def basinhopping(fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
    """Take Metropolis steps of up to a quarter of the box between the ends of descents, from a random start."""
    start, step = rng.uniform(*bounds.T), float(np.ptp(bounds, axis=1).mean()) / 4
    local = {"method": "L-BFGS-B", "bounds": Bounds(*bounds.T)}
    return Found.one(optimize.basinhopping(fun, start, stepsize=step, minimizer_kwargs=local, rng=rng).x)


def bipop(fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
    """Run CMA-ES with restarts of alternately large and small populations, each from a random start."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the import, about matplotlib; of flat ground
        import cma

        half = np.ptp(bounds, axis=1) / 2
        options = {"bounds": list(bounds.T), "CMA_stds": half, "seed": int(rng.integers(1, 2**31)), "verbose": -9}
        cma.fmin2(fun, lambda: rng.uniform(*bounds.T), 0.5, options, restarts=9, bipop=True)
    return Found.one(fun.best_x)


def mlsl(fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
    """Descend by SLSQP from points of a low-discrepancy sequence, once per neighbourhood.

    Where nlopt gives up, as it does on values of 1e11 (Shubert in ten dimensions), the best point until then counts.
    """
    import nlopt

    def value(x: Array, gradient: Array) -> float:
        here = fun(x)
        if gradient.size:
            gradient[:] = forward_differences(fun, x, here, bounds)
        return here

    dim = len(bounds)
    nlopt.srand(int(rng.integers(2**31)))
    search, local = nlopt.opt(nlopt.G_MLSL_LDS, dim), nlopt.opt(nlopt.LD_SLSQP, dim)
    local.set_ftol_rel(1e-10)
    local.set_xtol_rel(1e-8)
    search.set_local_optimizer(local)
    search.set_lower_bounds(bounds[:, 0])
    search.set_upper_bounds(bounds[:, 1])
    search.set_min_objective(value)
    try:
        return Found.one(search.optimize(rng.uniform(*bounds.T)))
    except nlopt.nlopt.exception:
        return Found.one(fun.best_x)


def forward_differences(fun: Counted, x: Array, value: float, bounds: Array) -> Array:
    """Return the gradient (dim,) at x (dim,), where fun is `value`; backward at the upper bound."""
    steps = 1.5e-8 * np.maximum(1.0, np.abs(x))
    moved = x + np.diag(np.where(x + steps > bounds[:, 1], -steps, steps))
    return (fun.batch(moved) - value) / (np.diagonal(moved) - x)


def _by_scipy(name: Literal["dual_annealing", "differential_evolution", "direct"], **options: Any) -> Any:
    """Return the adapter of a function of scipy that lists one minimum."""

    def solve(fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
        chance = {} if name == "direct" else {"rng": rng}
        return Found.one(getattr(optimize, name)(fun, Bounds(*bounds.T), **options, **chance).x)

    return solve


CHEA = (
    Method(
        name="modern",
        solve=lambda *run: hybrid(*run, profile="modern"),
        settings="`chea(fun, bounds)`",
        package="rotorrig",
    ),
    Method(
        name="seed",
        solve=lambda *run: hybrid(*run, profile="seed"),
        settings='`profile="seed"`: Table 1 of the chapter',
        package="rotorrig",
    ),
)
PEERS = (
    Method(
        name="elitist GA",
        solve=elitist_ga,
        settings=f"the seed profile's genetic algorithm (Table 1) without clusters and far search, until {UNIMPROVED} "
        "generations bring nothing better; then one descent by SLSQP",
        package="rotorrig",
    ),
    Method(name="dual_annealing", solve=_by_scipy("dual_annealing", maxiter=500), settings="maxiter 500"),
    Method(
        name="differential_evolution",
        solve=_by_scipy("differential_evolution", popsize=30, tol=1e-6),
        settings="popsize 30, tol 1e-6, polished",
    ),
    Method(
        name="shgo 128",
        solve=lambda *run: shgo(*run, n=128),
        settings="128 points of a scrambled Sobol sequence",
        max_dim=6,
    ),
    Method(
        name="shgo 1024",
        solve=lambda *run: shgo(*run, n=1024),
        settings="1024 points of a scrambled Sobol sequence",
        max_dim=5,
    ),
    Method(
        name="basinhopping", solve=basinhopping, settings="100 descents by L-BFGS-B, first step a quarter of the box"
    ),
    Method(
        name="direct",
        solve=_by_scipy("direct", vol_tol=0.0),
        settings="vol_tol 0, at most 1,000 calls per dimension; the same in every run on the same box",
    ),
    Method(
        name="pycma BIPOP",
        solve=bipop,
        settings="9 restarts, first step half the half width; budget 7,000 calls in two dimensions",
        budget=7000,
        package="cma",
    ),
    Method(
        name="multistart SLSQP",
        solve=multistart,
        settings=f"{STARTS} starts of a scrambled Sobol sequence, ftol 1e-10; lists every end",
    ),
    Method(
        name="nlopt MLSL",
        solve=mlsl,
        settings="G_MLSL_LDS with LD_SLSQP, forward differences; budget 3,000 calls in two dimensions",
        budget=3000,
        package="nlopt",
    ),
)
METHODS = {method.name: method for method in (*CHEA, *PEERS)}
