"""What each fault of the simulated rig is made of, and what the effect of the same name is."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Mechanism:
    """One row of the table of docs/plant.md."""

    plant: str  # its mechanism
    source: str  # author and year; the title stands in the fault's file
    effect: str  # the law of the effect, "" if none models it
    is_definition: bool = False  # both are what the word means, and can differ in nothing but the rotor's model


MECHANISMS: Mapping[str, Mechanism] = MappingProxyType(
    {
        "bow": Mechanism(
            "curvature about a hot spot, falling off as heat does along a rod",
            "Incropera, DeWitt 1985; Boley, Weiner 1960",
            "the shape of a push at the disk, or an arc",
        ),
        "clearance": Mechanism(
            "a polygon of 8 balls that turns with the cage, springs behind it",
            "Fukata et al. 1985; Tiwari et al. 2000",
            "a circle",
        ),
        "couple": Mechanism("Euler's equations of a disk askew", "Friswell et al. 2010", "the same moment", True),
        "coupling": Mechanism(
            "universal joint with elastic arms, mean stiffness included, bushes that stiffen",
            "Seherr-Thoss et al. 2006; Xu, Marangoni 1994",
            "two force phasors and an uneven stiffness that turns",
        ),
        "crack": Mechanism(
            "opens as (1 + cos) / 2, gives across its mouth too; moments from its energy",
            "Mayes, Davies 1984; Papadopoulos, Dimarogonas 1987",
            "a hinge across the mouth that is open or shut (Gasch)",
        ),
        "cross_stiffness": Mechanism(
            "a coil spring too stiff, at 45 degrees: kxx, kyy and kxy at once",
            "Wahl 1963",
            "kxy = kyx alone",
        ),
        "cross_talk": Mechanism(
            "the coils' fields: a share that grows with the gaps",
            "Dodd, Deeds 1968",
            "a constant share",
        ),
        "cubic_spring": Mechanism(
            "short wires that stretch, straight before the weight was on them",
            "Nayfeh, Mook 1979",
            "k3 r^3 about the unloaded spring",
        ),
        "damping_over_speed": Mechanism("a squeeze film that the shaft's pump fills", "Gunter et al. 1977", ""),
        "delay": Mechanism(
            "anti-alias filter of second order",
            "Oppenheim, Willsky 1997",
            "a pure delay",
        ),
        "disk_inertia": Mechanism("the disk's moments of inertia", "-", "the same", True),
        "drag": Mechanism(
            "drag coefficient that falls with the Reynolds number, oil that turns with the disk",
            "White 1974; Muszynska 1986",
            "c2 v^2 against the velocity",
        ),
        "friction": Mechanism(
            "LuGre's bristles with Stribeck's curve",
            "Canudas de Wit et al. 1995",
            "an elastic slider that creeps",
        ),
        "hysteresis": Mechanism(
            "filled rubber: Bouc and Wen's friction beside a spring and dashpot in series",
            "Berg 1998; Wen 1976",
            "a constant loss factor, causal to second order",
        ),
        "internal_damping": Mechanism(
            "a standard linear solid in the shaft's own axes",
            "Genta, Amati 2010",
            "stress by a fractional derivative of the strain, in the shaft's axes",
        ),
        "line_hum": Mechanism(
            "a tone and its third, unlike in every probe, at a frequency that strays",
            "Ott 2009; Weissbach, Welfonder 2009",
            "one steady tone, the same in all probes, but for what tracking finds of its straying and shares",
        ),
        "loose_disk": Mechanism("a ring that rolls on a rod and falls behind", "rolling without slip", ""),
        "loose_pedestal": Mechanism("a bolt that opens once per turn", "Muszynska, Goldman 1995", ""),
        "magnetic_pull": Mechanism("a pole that pulls as 1 / gap^2, until it saturates", "Schweitzer, Maslen 2009", ""),
        "pedestal": Mechanism(
            "a block that slides and rocks along x, a mass on a spring along y",
            "Gasch et al. 2002; Richart et al. 1970",
            "one mass on one spring along x",
        ),
        "probe_angle": Mechanism("the direction a probe looks in", "-", "the same", True),
        "probe_bracket": Mechanism("a mass on a spring upon a base that moves a little", "Thomson 1981; API 670", ""),
        "probe_curvature": Mechanism("a calibration table", "API 670; Dodd, Deeds 1968", ""),
        "probe_gain": Mechanism("the scale factor of a probe", "-", "the same", True),
        "rub": Mechanism(
            "a ring in rubber that creeps back, with friction",
            "Jiang, Ulbrich 2005",
            "a stiff wall at the disk, with friction",
        ),
        "runout": Mechanism(
            "a profile with a dent, and electrical run-out of each probe's own",
            "API 670; Littrell 2005",
            "one phasor of the track per order",
        ),
        "seal": Mechanism("damping in axes that turn with the liquid", "Black 1969; Muszynska 1986", ""),
        "shaft_asymmetry": Mechanism(
            "a flat between the bearings, which softens the mean too",
            "Dimentberg 1961",
            "+-delta all along the shaft, to first order at 2X",
        ),
        "skew_stiffness": Mechanism(
            "a seal's push in proportion to its torque, and so to speed",
            "Alford 1965",
            "constant kxy = -kyx",
        ),
        "slipping_coupling": Mechanism("a hub that creeps while the shaft is sped up", "Coulomb friction", ""),
        "snubber": Mechanism("a soft ring without friction, off centre, beyond a gap", "Karpenko et al. 2002", ""),
        "soft_left_bearing": Mechanism(
            "a rubber seat in series: it damps, and is stiffer along gravity",
            "Smalley et al. 1978",
            "stiffnesses lower by one ratio",
        ),
        "stiffness_over_speed": Mechanism(
            "Hertz contact under centrifugal load, (1 + (W / W_r)^2)^(1/3)",
            "Jones 1960; Harris 1966",
            "the square of the speed",
        ),
        "twice_line_pull": Mechanism("half of a pull that swings at 100 Hz", "Finley et al. 2000", ""),
        "unbalance_drift": Mechanism(
            "moves as a disk warms: 1 - exp(-t / T)",
            "Incropera, DeWitt 1985; Zawoysky, Genovese 2001",
            "",
        ),
        "unbalance_plane": Mechanism(
            "a screw that is heavy too, anywhere along the shaft",
            "ISO 21940-2",
            "the unbalance alone, from a grid of places",
            True,
        ),
        "unbalance_step": Mechanism(
            "a screw that leaves over half a second, at a speed",
            "Muszynska 2005",
            "a step at a time",
        ),
    }
)
