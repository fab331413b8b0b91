"""Tuning of the extended model: differences, bounds, what it follows and what it keeps."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtendedModelSettings:
    """Steps of differences, bounds and nuisances of effects, motion under force laws, rotors kept."""

    # differences
    step: float = 1e-4  # of an effect's size: vectors
    matrix_step: float = 1e-5  # of an effect's size: its matrices
    structure_step: float = 1e-7  # of the base's structure, m and shares: a bearing pair's element is some mm long
    tilt_step: float = 1.0  # N m/rad, of a tilt stiffness, in which the matrices are linear
    law_step: float = 1e-5  # of an unknown in working coordinates: loads and laws

    # unknowns
    fit_range: float = 2.0  # times its plausible range an unknown may be fitted: what ends there says so
    wider: float = 4.0  # times its standard deviation a prior is of what the config is found to have wrong
    roundness: float = 0.5  # of what a round shaft does to a reading across, in one standard deviation: part is seen
    mark_width: float = 0.35  # rad, one standard deviation: a notch of 20 degrees is common

    # motion under force laws
    highest_law_order: int = 2  # at which a force law is followed
    largest_motion: float = 0.1  # m: no rotor kit does

    # what is kept
    recent: int = 4  # responses, motions under force laws: the next question is often about the same one
    recent_rotors: int = 64  # a Jacobian asks for one a step along every unknown, the next for most of them again


ORDERS = (1, 2, 3)  # that a model may predict, where they were tracked
EXTENDED_MODEL = ExtendedModelSettings()
