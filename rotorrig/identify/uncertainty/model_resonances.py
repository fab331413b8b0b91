"""Critical speeds of a fitted model: read off the curves that it predicts, with the uncertainty of its parameters."""

from collections.abc import Iterator

import numpy as np

from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.identify.identification import ModelResonance
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty.motion_columns import Complex, covariance_root, motion_with_columns
from rotorrig.processing import find_resonances


def model_resonances(best: Solution, problem: ExtendedProblem) -> tuple[ModelResonance, ...]:
    """Return the resonances of every run, probe by probe, as the fit predicts them; none of amplitudes alone."""
    if problem.model.amplitudes_alone:
        return ()
    motions = motion_with_columns(problem, best.p, covariance_root(best.covariance))
    pairs = zip(problem.recordings, motions, strict=True)
    return tuple(each for recording, (z, columns) in pairs for each in _of_recording(recording, z, columns))


def _of_recording(recording: Recording, z: Complex, columns: Complex) -> Iterator[ModelResonance]:
    response = recording.response
    for run in np.unique(response.run[recording.rows]):
        here = response.run[recording.rows] == run
        rows = recording.rows[here]
        if not response.runs[run].direction:
            continue  # a dwell makes no curve
        for n, probe in enumerate(response.probes):
            found = find_resonances(
                response.omega[rows], z[here, n], steps=columns[here, n], rate=response.rate(int(run))
            )
            for each in found:
                yield ModelResonance(
                    response=recording.number, run=response.runs[run].name, probe=probe, resonance=each
                )
