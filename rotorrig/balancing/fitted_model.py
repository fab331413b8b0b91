"""`Influence` of a fitted rotor model: no trial run is needed, but the mark and the probes' scale must be right.

The fit is taken up where fit.json ends: its unknowns and nuisances, and their covariance from the responses it was made
of. The unbalance found and what a mass does come from one vector of parameters, so their errors go together.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from rotorrig.balancing.influence import MODEL, Influence
from rotorrig.balancing.row_curves import MOST_ROWS
from rotorrig.identify import BaseProblem, Estimate, Identification, config_effects
from rotorrig.identify.extended_model import ExtendedProblem, Recording, recordings_of
from rotorrig.identify.uncertainty import covariance_root, motion_with_columns
from rotorrig.processing import OrderTrackedResponse, require_phases
from rotorrig.rig import DataError

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

UNIT = 1e-5  # kg m, of the mass whose effect is taken: 10 g mm; the model is linear
STEPS = 3  # of least squares on from fit.json: it is at the minimum already


def influence_of_fit(
    identification: Identification, responses: Sequence[OrderTrackedResponse], *, planes: Sequence[str]
) -> Influence:
    """Return the vibration that a fit predicts with masses on `planes`, beside what its first response measured.

    Raises DataError if a response that the fit was made of is not among `responses`, or the model has force laws.
    """
    require_phases(responses, "a prediction")
    if identification.trial_angles:
        raise DataError(
            "the fit counts the angles of the trial masses otherwise than they were told, want them told so and the "
            "fit made anew: a correction is told as they are"
        )
    used = _responses_of(identification, responses)
    with threadpool_limits(1, user_api="blas"):
        problem = BaseProblem.of(recordings_of(used, orders=(1,)), config_effects(used[0].rig)).problem
        p = _parameters_of(identification, problem)
        if problem.model.moving(p).laws:
            raise DataError(
                "the fitted model has a force law, so vibration is not proportional to masses; want --trial"
            )
        solved = problem.expecting_error(p).solve(p, max_steps=STEPS)
        recording, root = problem.recordings[0], covariance_root(solved.covariance)

        def motion(trial: dict[str, complex]) -> tuple[Complex, Complex]:
            return motion_with_columns(problem.on([recording.with_trial(trial)]), solved.p, root)[0]

        z, z_columns = motion({})
        moved = [motion({plane: UNIT}) for plane in planes]
    H = np.stack([vectors - z for vectors, _ in moved], axis=-1) / UNIT
    H_columns = np.stack([columns - z_columns for _, columns in moved], axis=2) / UNIT
    return _entries(recording, tuple(planes), z, H, z_columns, H_columns)


def _entries(
    recording: Recording, planes: tuple[str, ...], z: Complex, H: Complex, z_columns: Complex, H_columns: Complex
) -> Influence:
    """Return the influence of thinned rows of a recording, of arrays (row, probe, ...)."""
    response, prior = recording.response, recording.rig.prior
    n = response.orders.index(1.0)
    direction = np.array([run.direction for run in response.runs])[response.run[recording.rows]]
    rows = _thin(direction)
    row, probe = np.nonzero(recording.measured[1].usable[:-1][rows])
    row = rows[row]
    at = recording.rows[row]
    trial = np.stack([np.asarray(recording.trial.get(p, np.zeros(len(z) + 1))) for p in planes], axis=-1)[row]
    raw = response.z[at, probe, n] - np.nan_to_num(response.slow_roll[probe, n])
    measured = raw - np.einsum("mp,mp->m", H[row, probe], trial)
    noise = np.diagonal(response.covariance[at, n], axis1=1, axis2=2)
    own = noise[np.arange(len(at)), 2 * probe] + noise[np.arange(len(at)), 2 * probe + 1]
    off = prior.model_error * np.array([1, 1j])  # of the model as a whole: of z and of H alike
    parts = prior.repeatability * measured[:, None] * np.array([1, 1j])
    z, H = z[row, probe], H[row, probe]
    return Influence(
        by=MODEL,
        probes=response.probes,
        planes=planes,
        probe=probe,
        omega=response.omega[at],
        direction=direction[row],
        z=z,
        H=H,
        z_columns=np.concatenate([z_columns[row, probe], z[:, None] * off], axis=-1),
        H_columns=np.concatenate([H_columns[row, probe], H[..., None] * off], axis=-1),
        measured=measured,
        measured_columns=np.zeros((len(row), z_columns.shape[-1] + 2), complex),
        next_run=np.sqrt(2) * parts,  # this run and the next stray each
        own=np.zeros(len(row)),
        measured_own=own,
        spread=np.eye(1 + len(planes), 1, dtype=complex),
        typical=np.inf,
        dof=np.inf,
    )


def _responses_of(
    identification: Identification, responses: Sequence[OrderTrackedResponse]
) -> list[OrderTrackedResponse]:
    rest, used = list(responses), []
    for of, rows in identification.responses:
        same = next((r for r in rest if (r.source.source_hash, len(r.omega)) == (of, rows)), None)
        if same is None:
            raise DataError(
                f"the fit was made of a response that was not given ({rows} rows of {of}), want all of them"
            )
        rest = [r for r in rest if r is not same]
        used.append(same)
    used = used or rest[:1]
    labels = tuple(effect.label for effect in used[0].rig.effects)
    if labels != identification.effects:
        raise DataError(
            f"the fit has the effects {list(identification.effects)}, its response {list(labels)}, want both the same"
        )
    return used


def _parameters_of(identification: Identification, problem: ExtendedProblem) -> Reals:
    """Return the vector of a problem that a fit ended at. Raises DataError if it is of another rig."""
    fit, names = identification.fits[0], problem.parameters
    space = names.base.space
    p = names.start(np.zeros(0))
    try:
        p[names.base.sought] = space.to_working([fit.estimate(name).value for name in space.names])
        for i, (amount, phase) in enumerate(zip(space.amounts, space.phases, strict=True)):
            u = fit.estimate(amount.name).value * np.exp(1j * fit.estimate(phase).value)
            p[names.base.unbalance.start + 2 * i : names.base.unbalance.start + 2 * i + 2] = u.real, u.imag
        nuisances = {e.name: e for e in fit.nuisances}
        _fill(p, names.names, nuisances, _sizes(problem), skipped=(names.base.sought, names.base.unbalance))
    except (KeyError, StopIteration) as error:
        raise DataError("the fit is of another rig or another version, want one of these responses") from error
    return p


def _fill(
    p: Reals,
    names: Sequence[str],
    nuisances: Mapping[str, Estimate],
    sizes: Reals,
    *,
    skipped: Sequence[slice],
) -> None:
    taken = {i for part in skipped for i in range(part.start, part.stop)}
    for i, name in enumerate(names):
        if i not in taken:
            p[i] = nuisances[name].value / sizes[i]


def _sizes(problem: ExtendedProblem) -> Reals:
    own = [q.size for effect in problem.effects for q in effect.parameters]
    return np.append(np.ones(problem.parameters.own.start), own)


def _thin(direction: NDArray[np.intp]) -> NDArray[np.intp]:
    kept = []
    for way in np.unique(direction):
        rows = np.flatnonzero(direction == way)
        kept.append(rows[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), MOST_ROWS)).round().astype(int))])
    return np.sort(np.concatenate(kept))
