"""Description of a stretch of speeds where model and measurement part: size, sign, direction of whirl."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.adequacy.mean_position import MEAN
from rotorrig.identify.adequacy.settings import ADEQUACY
from rotorrig.processing import OrderTrackedResponse, measured_planes, whirl
from rotorrig.rig.config import RPM, micrometres

Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Misfit:
    """A stretch of one probe, order and run where model and measurement part."""

    run: str
    probe: str
    order: float  # 0: of the mean position, by how much it moves
    speed_from: float  # rad/s
    speed_to: float  # rad/s
    sigma: float  # root mean square of the whitened residual over the stretch
    residual: float  # m, largest 0-peak magnitude in it
    relative: float  # mean (|measured| - |model|) / |model|; NaN where the model has no such order
    phase: float  # rad, mean arg(measured / model); NaN likewise
    backward: float = float("nan")  # share of the residual's square that whirls backward; NaN without a second probe
    other_run: str = ""  # what a run of the other direction shows there: "the same in the down run"; "": none
    sentence: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """Consecutive rows of one run, probe and order."""

    run: int
    probe: int
    order: int
    rows: NDArray[np.intp]
    sigma: float


def describe_misfit(
    response: OrderTrackedResponse, prediction: Mapping[int, Complex], residual: Complex, s: Stretch
) -> Misfit:
    """Describe a stretch; `prediction` is order -> (speed, probe) m, `residual` (speed, probe, order) m."""
    order = response.orders[s.order]
    relative = phase = float("nan")
    if order == 1:
        model = prediction[1][s.rows, s.probe]
        measured = response.z[s.rows, s.probe, s.order]
        relative = float(np.nanmean(np.abs(measured)) / np.nanmean(np.abs(model)) - 1)
        phase = float(np.angle(np.nansum(measured * np.conj(model))))
    omega = response.omega[s.rows]
    off = np.abs(residual[s.rows, s.probe, s.order])
    backward, other_run = _backward(response, residual, s), _other_run(response, residual, s)
    return Misfit(
        run=response.runs[s.run].name,
        probe=response.probes[s.probe],
        order=order,
        speed_from=float(omega.min()),
        speed_to=float(omega.max()),
        sigma=s.sigma,
        residual=float(np.nanmax(off)),
        relative=relative,
        phase=phase,
        backward=backward,
        other_run=other_run,
        sentence=_sentence(response, s, off, relation=_relation(relative, phase), more=[_turning(backward), other_run]),
    )


def _sentence(
    response: OrderTrackedResponse, s: Stretch, off: NDArray[np.float64], *, relation: str, more: list[str]
) -> str:
    omega = response.omega[s.rows]
    name, order = response.probes[s.probe], response.orders[s.order]
    size = f"{micrometres(np.nanmax(off))} um{'' if order == MEAN else ' 0-peak'}"
    seen = f"{size} at {omega[np.nanargmax(off)] * RPM:.0f} rpm, {s.sigma:.0f} sigma"
    what = f"probe {name} shows {order:g}X of up to {seen}, where the linear model has none"
    if order == 1:
        what = f"probe {name} departs from the model by up to {seen} ({relation})"
    if order == MEAN:
        what = f"the mean position at probe {name} moves by up to {seen}"
    where = f"In the {response.runs[s.run].name} run, {omega.min() * RPM:.0f} to {omega.max() * RPM:.0f} rpm"
    return ", ".join([where, what, *filter(None, more)]) + "."


def _relation(relative: float, phase: float) -> str:
    """Say how the measurement stands to the model; a falling phase is a growing lag."""
    size = f"{abs(relative):.1%} {'high' if relative > 0 else 'low'}"
    return f"on average {size} and {abs(np.degrees(phase)):.1f} deg {'early' if phase > 0 else 'late'}"


def _backward(response: OrderTrackedResponse, residual: Complex, s: Stretch) -> float:
    """Return the share of the residual's square that whirls backward in the plane of the probe; NaN of the mean."""
    if response.orders[s.order] == MEAN:
        return float("nan")
    for plane, pair in measured_planes(response.rig, response.probes):
        if s.probe in pair:
            vectors = whirl(plane, residual[s.rows][:, pair, s.order], rotation=response.rig.rotation)
            forward, backward = (float(np.nansum(np.abs(z) ** 2)) for z in vectors)
            return backward / (forward + backward) if forward + backward else float("nan")
    return float("nan")


def _turning(backward: float) -> str:
    if backward >= ADEQUACY.one_sided:
        return f"{backward:.0%} of it whirling backward"
    if backward <= 1 - ADEQUACY.one_sided:
        return f"{1 - backward:.0%} of it whirling forward"
    return ""


def _other_run(response: OrderTrackedResponse, residual: Complex, s: Stretch) -> str:
    """Compare with the first run of the other direction, at the same speeds."""
    omega = response.omega[s.rows]
    mine = residual[s.rows, s.probe, s.order]
    for i, run in enumerate(response.runs):
        if run.direction * response.runs[s.run].direction != -1:
            continue
        there = (response.run == i) & (response.omega >= omega.min()) & (response.omega <= omega.max())
        rows = np.flatnonzero(there & np.isfinite(residual[:, s.probe, s.order]))
        if len(rows) < ADEQUACY.least_rows:
            continue
        rows = rows[np.argsort(response.omega[rows])]
        theirs = np.interp(omega, response.omega[rows], residual[rows, s.probe, s.order])
        return f"{_compare(mine, theirs)} in the {run.name} run"
    return ""


def _compare(mine: Complex, theirs: Complex) -> str:
    size = float(np.sqrt(np.nanmean(np.abs(mine) ** 2)))
    apart, their_size = (float(np.sqrt(np.nanmean(np.abs(z) ** 2))) for z in (theirs - mine, theirs))
    if apart < ADEQUACY.alike * size:
        return "the same"
    if their_size < ADEQUACY.alike * size:
        return "hardly any"
    return "otherwise" if their_size < size / ADEQUACY.alike else "much more"
