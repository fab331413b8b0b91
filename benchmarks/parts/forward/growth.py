"""How the cost of a response grows with the model, the speeds and the parameters, on the RK4."""

import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.forward.peers import dense
from benchmarks.parts.tables import markdown
from rotorrig.rig.config import RigConfig
from rotorrig.sims.rotor.model import assemble, unbalance_direction
from rotorrig.sims.rotor.steady import condense_groups
from rotorrig.sims.rotor.steady.receptance import condense

POPULATION = 200
LARGEST_DENSE = 100  # elements up to which the dense solve is timed
NAMEPLATE = (33.9e3, 34.6e3, 15.0, 15.0, 15e-6)


def growth_tables(rig: RigConfig, omega: NDArray[np.float64]) -> list[str]:
    """Return how the cost grows with elements, speeds and parameters, on the RK4."""
    return [
        markdown(
            ("elements", "DOF", "condensed once, ms", "a candidate, us", "dense, us"), list(_by_elements(rig, omega))
        ),
        markdown(("speeds", "a candidate, us", "per speed, ns"), list(_by_speeds(rig, omega))),
        markdown(
            ("groups of bearings", "k, c, u", "response, us", "with Jacobian, us", "ratio"),
            list(_by_groups(rig, omega)),
        ),
    ]


def _by_elements(rig: RigConfig, omega: NDArray[np.float64]) -> Iterator[tuple[str, ...]]:
    rows, works = [], []
    for elements in (10, 30, 100, 300, 1000):
        model = assemble(rig, max_element=rig.shaft.length / elements)
        cpu = time.process_time()
        receptance = condense(model, omega, bearings=["spring"], disk="disk")
        once = time.process_time() - cpu
        works.append(partial(receptance.response, *_candidates()))
        plain = "-"
        if elements <= LARGEST_DENSE:
            response = dense(model, omega, bearings=("spring",), disk="disk")
            plain = f"{_cpu(partial(response, *NAMEPLATE), repeats=1):,.0f}"
        rows.append((str(len(model.z) - 1), str(model.dof), f"{once * 1e3:,.0f}", plain))
    turns = [[_cpu(work, repeats=1) for work in works] for _ in range(51)]  # in turns: the machine's pace changes
    for (elements, dof, once, plain), each in zip(rows, np.median(turns, axis=0) / POPULATION, strict=True):
        yield elements, dof, once, f"{each:.1f}", plain


def _by_speeds(rig: RigConfig, omega: NDArray[np.float64]) -> Iterator[tuple[str, ...]]:
    model, theta = assemble(rig), _candidates()
    for speeds in (21, 84, 336, 1344):
        receptance = condense(model, np.linspace(omega[0], omega[-1], speeds), bearings=["spring"], disk="disk")
        each = _cpu(partial(receptance.response, *theta)) / POPULATION
        yield str(speeds), f"{each:.1f}", f"{each / speeds * 1e3:.0f}"


def _by_groups(rig: RigConfig, omega: NDArray[np.float64]) -> Iterator[tuple[str, ...]]:
    model = assemble(rig)
    forces = omega[:, None, None] ** 2 * unbalance_direction(model.disk("disk"), model.rotation)[:, None]
    names = [b.name for b in reversed(rig.bearings)]
    for count in range(1, len(names) + 1):
        receptance = condense_groups(model, omega, groups=[[name] for name in names[:count]], forces=forces)
        K, C = (np.array([A] * count) for A in (np.diag(NAMEPLATE[:2]), np.diag(NAMEPLATE[2:4])))
        one = K, C, np.array([NAMEPLATE[4]])
        value = _cpu(partial(receptance.general_response, *one), calls=200)
        both = _cpu(partial(receptance.response_and_derivatives, *one), calls=200)
        yield str(count), str(8 * count + 1), f"{value:.1f}", f"{both:.1f}", f"{both / value:.1f}"


def _candidates() -> NDArray[np.float64]:
    rng = np.random.default_rng(0)
    return np.array(NAMEPLATE)[:, None] * 10 ** rng.uniform(-1, 1, (5, POPULATION))


def _cpu(work: Callable[[], object], *, calls: int = 5, repeats: int = 11) -> float:
    """Return the median CPU time of a call [us]."""
    calls = 1 if repeats == 1 else calls
    work()
    samples = []
    for _ in range(repeats):
        began = time.process_time()
        for _ in range(calls):
            work()
        samples.append((time.process_time() - began) / calls * 1e6)
    return statistics.median(samples)
