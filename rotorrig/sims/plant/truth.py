"""A simulated rig as it really is: hidden deviations from the nameplate, noise levels, faults.

A `Truth` is drawn from a seed (draw.py), sealed into a JSON file before a sweep (sealed_truth.py), and opened only by
a scorer after a diagnosis has been written.
"""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultSpec:
    """A fault by the name of its file in `faults/`; parameters left out take that file's defaults."""

    name: str
    parameters: dict[str, float] = field(default_factory=dict)  # SI


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingTruth:
    """The eight coefficients a bearing really has, [N/m] and [N s/m]."""

    name: str
    kxx: float
    kyy: float
    kxy: float
    kyx: float
    cxx: float
    cyy: float
    cxy: float
    cyx: float


@dataclass(frozen=True, slots=True, kw_only=True)
class UnbalanceTruth:
    """The unbalance a disk really has."""

    disk: str
    amount: float  # kg m
    angle: float  # rad from shaft angle zero, in the sense of rotation


@dataclass(frozen=True, slots=True, kw_only=True)
class Noise:
    """Everything random after the start; the defaults are a good rotor kit's, `Noise.none()` is silence."""

    probe: float = 1.5e-3  # V rms, white
    keyphasor: float = 5e-3  # V rms, white
    hum: float = 1e-7  # m, 0-peak, at the mains' 50 Hz, the same in all probes
    bearing_force: float = 1.0e-3  # N per root Hz, one-sided, x and y of each identified bearing
    hunting: float = 5e-4  # relative rms of the powered speed

    @classmethod
    def none(cls) -> "Noise":
        """Return a rig without noise."""
        return cls(probe=0.0, keyphasor=0.0, hum=0.0, bearing_force=0.0, hunting=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Unmodelled:
    """What any healthy rig does besides, and no nameplate speaks of; nothing of it by default. See `deviations`."""

    coupling_stiffness: float = 0.0  # N/m, sideways, between the motor's shaft and the driven end
    coupling_loss: float = 0.0  # loss factor of that stiffness, as a dashpot that has it at the reference speed
    supply_ripple: float = 0.0  # V, 0-peak, at twice the mains' frequency on every driver's output
    gain_drift: tuple[float, ...] = ()  # per probe, relative, once warm
    gap_drift: tuple[float, ...] = ()  # m, per probe, once warm
    noise_growth: float = 0.0  # of the bearings' force with speed: coloured, over the white one, at the reference
    damping_growth: float = 0.0  # of the sought bearings' damping per reference speed, relative to that at it
    base_share: float = 0.0  # of what a bearing sought does, that the base plate does under it and the probes by it
    base_frequency: float = 0.0  # Hz, of the base plate
    mark_lead: float = 0.0  # rad/m, by which the mark comes early as the driven end moves on with the surface it is on
    keyphasor_direction: float = 0.0  # rad from x to y, in which the keyphasor stands


@dataclass(frozen=True, slots=True, kw_only=True)
class Geometry:
    """How the rig was put together, against the nameplate; as it says by default. See `deviations`."""

    disk_shifts: tuple[float, ...] = ()  # m, each disk further from the coupling
    bearing_shifts: tuple[float, ...] = ()  # m
    probe_shifts: tuple[float, ...] = ()  # m
    diameter_factor: float = 1.0  # of the shaft
    hub_factors: tuple[float, ...] = ()  # of the shaft's diameter under each disk, never less than 1
    tilt_stiffnesses: tuple[float, ...] = ()  # N m/rad, each bearing's


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """One rig as it is. Tuples follow the order of the config's bearings, disks and probes."""

    config_hash: str
    seed: int
    bearings: tuple[BearingTruth, ...]
    unbalances: tuple[UnbalanceTruth, ...]  # one per disk
    modulus_factor: float
    density_factor: float
    disk_mass_factors: tuple[float, ...]  # on mass and both inertias
    probe_gain_factors: tuple[float, ...]
    probe_angle_errors: tuple[float, ...]  # rad, added to the config's angle
    probe_curvatures: tuple[tuple[float, float], ...]  # see sensors.channels.apply_curvature
    keyphasor_offset: float  # rad, shaft angle at which the chosen edge is emitted
    runout_seed: int | None  # None: shafts perfectly round
    noise: Noise
    unmodelled: Unmodelled = field(default_factory=Unmodelled)
    geometry: Geometry = field(default_factory=Geometry)
    faults: tuple[FaultSpec, ...] = ()
    trial: tuple[UnbalanceTruth, ...] = ()  # put on for this run
    run: int = 0  # tells the noise of one run of a rig from the next one's
