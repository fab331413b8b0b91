"""Numbers for plots, shared by report, viewer and documents.

Curves over speed, critical speeds, orbits, spectra and time bases of a recording, centrelines, thinning.
"""

from rotorrig.app.plot_data.cause_places import cause_places
from rotorrig.app.plot_data.centreline_paths import (
    BEYOND,
    REFERENCE,
    SMALLEST_PATH,
    CentrelinePath,
    ClearanceCircle,
    centreline_paths,
    centreline_words,
    clearance_circle,
    half_width,
    is_seen_in,
)
from rotorrig.app.plot_data.curves import (
    Curve,
    curves,
    lag_degrees,
    model_vectors,
    phase_window,
    residual_grid,
    slow_roll_known,
    sweeps,
    vectors,
    whirl_grid,
)
from rotorrig.app.plot_data.diagnosis_of_response import (
    Vectors,
    check_balance_of,
    check_run_of,
    choose_resonances,
    fits_of,
    part_of,
    predictions,
)
from rotorrig.app.plot_data.model_path import model_path
from rotorrig.app.plot_data.nice_numbers import nice
from rotorrig.app.plot_data.orbits import Plane, orbit, representative_rows
from rotorrig.app.plot_data.order_spectrum import OrderSpectrum, order_spectra
from rotorrig.app.plot_data.resonances import CriticalSpeed, critical_speeds
from rotorrig.app.plot_data.speed_spectra import DECADES, SpeedSpectra, decibels, order_mark, speed_spectra
from rotorrig.app.plot_data.thinning import thin_curve, thin_indices
from rotorrig.app.plot_data.time_bases import TimeBase, time_bases

__all__ = [
    "BEYOND",
    "DECADES",
    "REFERENCE",
    "SMALLEST_PATH",
    "CentrelinePath",
    "ClearanceCircle",
    "CriticalSpeed",
    "Curve",
    "OrderSpectrum",
    "Plane",
    "SpeedSpectra",
    "TimeBase",
    "Vectors",
    "cause_places",
    "centreline_paths",
    "centreline_words",
    "check_balance_of",
    "check_run_of",
    "choose_resonances",
    "clearance_circle",
    "critical_speeds",
    "curves",
    "decibels",
    "fits_of",
    "half_width",
    "is_seen_in",
    "lag_degrees",
    "model_path",
    "model_vectors",
    "nice",
    "orbit",
    "order_mark",
    "order_spectra",
    "part_of",
    "phase_window",
    "predictions",
    "representative_rows",
    "residual_grid",
    "slow_roll_known",
    "speed_spectra",
    "sweeps",
    "thin_curve",
    "thin_indices",
    "time_bases",
    "vectors",
    "whirl_grid",
]
