"""Tuning of the base model: its mesh and bounds, the global search, and the refinement."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseModelSettings:
    """Sizes of the models, bounds beside the config's, rows and steps."""

    # the models
    modes: int = 6  # beside the static shapes: 3e-10 of the peak from the full model on the RK4, twice as fast as ten
    span_modes: int = 5  # in either plane, where the nameplate may be off: 2e-5 of the peak, all of it off by 3 sigmas
    element: float = 0.05  # m: 2e-5 of the peak from a mesh of 20 mm on configs/rk4.toml, made in half the time

    # bounds
    furthest: float = 8.0  # prior sigmas, of positions, diameter and tilt stiffness
    stiffest_hub: float = 0.89  # of the shaft's flexibility, that a hub may take away
    nameplate_range: float = 0.3  # relative, of nuisances: beyond that the nameplate is not of this rig
    free_range: float = 3.0  # modulus and density from a third to three times the nameplate's: any metal
    at_bound: float = 0.01  # in working coordinates: an unknown that ends so near a bound is at it

    # global search
    amplitude_rows: int = 120  # of which amplitudes are compared; what their objectives find is not refined
    vector_rows: int = 60  # whose vectors are looked at; more tell it nothing new, and all take part in the refinement
    faint: float = 3.0  # sigmas below which the logarithm of an amplitude would be noise
    planes_apart: float = 1e-14  # of the normal matrix: two planes in one place are not told apart, but no error either
    rounding: float = 1e-9  # of the response: so good are the receptances
    first_step: float = 0.02  # of the cube: from a minimum of the shape towards that of an objective
    descent: int = 100  # calls from the one to the other,
    fine: float = 1e-10  # which ends when a step promises less, of the cost of f1

    black_box: int = 10_000  # calls of an objective that is searched by its values: three times the chapter's
    significant: float = 4.0  # times its least value: a minimum above explains nothing
    shown: int = 500  # points of a search that are kept for its picture

    # refinement
    near: float = 1.0  # of chi2: from here on all parameters are freed


BASE_MODEL = BaseModelSettings()
