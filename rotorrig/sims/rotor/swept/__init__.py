"""Response while the speed changes, as a tracking filter measures it: passed modes in time, averaged over windows."""

from rotorrig.sims.rotor.swept.envelope import polynomial
from rotorrig.sims.rotor.swept.excitation import sample_excitation
from rotorrig.sims.rotor.swept.passed_modes import PassedModes, Spectra, fit_passed_modes
from rotorrig.sims.rotor.swept.passed_modes_derivatives import differentiate_passed_modes
from rotorrig.sims.rotor.swept.swept_response import project_to_probes, swept_columns, swept_derivatives
from rotorrig.sims.rotor.swept.swept_solution import solve_sweep
from rotorrig.sims.rotor.swept.time_stepping import SMOOTH, STRAIGHT, add_matrix, invert
from rotorrig.sims.rotor.swept.timeline import TURN, Timeline
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows, tracked_rows, window_weights

__all__ = [
    "SMOOTH",
    "STRAIGHT",
    "TURN",
    "PassedModes",
    "Spectra",
    "Timeline",
    "TrackedRows",
    "add_matrix",
    "differentiate_passed_modes",
    "fit_passed_modes",
    "invert",
    "polynomial",
    "project_to_probes",
    "sample_excitation",
    "solve_sweep",
    "swept_columns",
    "swept_derivatives",
    "tracked_rows",
    "window_weights",
]
