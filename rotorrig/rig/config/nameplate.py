"""The rotor of a nameplate: shaft, disks, balance planes, bearings and probes, each a checked table in SI units.

Axes: z along the shaft from the coupling, x and y across it, angles from +x towards +y.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator, model_validator

from rotorrig.rig.config.units import reads
from rotorrig.rig.errors import ConfigError

COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
NUMBER, TABLE = "<number>", "<table>"  # the two forms of a bearing coefficient, as pydantic names them in its errors
SHORTEST = 1e-6  # m: places nearer than this are one place, so no section may be as short
LONGEST_SHAFT = 20.0  # m; the matrices of a model grow with its square
AGREE = 1e-6  # m: rounding of a length that is given twice


def _check_text(text: str) -> str:
    """Return text that a terminal shows and does not obey. Raises ValueError."""
    odd = next((letter for letter in text if not letter.isprintable() and letter not in "\n\r\t"), "")
    if odd:
        raise ValueError(f"has the control character U+{ord(odd):04X}, want text that can be printed")
    return text


def _check_name(name: str) -> str:
    if not name.isprintable() or not name.strip() or len(name) > LONGEST_NAME:
        raise ValueError(f"got {name[:LONGEST_NAME]!r}, want 1 to {LONGEST_NAME} characters that can be printed")
    return name


def check_size(number: float) -> float:
    """Return a number that 64 bits hold and squares of which stay finite. Raises ValueError for any other."""
    if abs(number) > LARGEST if isinstance(number, float) else abs(number) >= 2**63:
        raise ValueError(f"got {number:.4g}, want a number of a size that can be meant")
    return number


LARGEST = 1e30  # of a number in a unit that is not known here
LONGEST_NAME = 500  # characters: it stands in tables, in headings and in the names of others
LONGEST_PROBE = 60  # characters: it stands in names of topics, columns and files
MOST_CHANNELS = 1024  # of a DAQ
MOST = 256  # parts of a kind; a list of a million would be checked for hours
TAKEN = ("keyphasor", "time")  # topics and columns beside those of the probes
Text = Annotated[str, AfterValidator(_check_text)]
Name = Annotated[str, AfterValidator(_check_name)]


class Part(BaseModel):
    """A table of the config: frozen, and no key it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


Length = Annotated[float, reads("length"), Field(gt=0)]
Position = Annotated[float, reads("length"), Field(ge=0)]
Mass = Annotated[float, reads("mass"), Field(gt=0)]
Inertia = Annotated[float, reads("inertia"), Field(ge=0)]  # 0: a point mass
Density = Annotated[float, reads("density"), Field(gt=0)]
Modulus = Annotated[float, reads("modulus"), Field(gt=0)]
PoissonRatio = Annotated[float, Field(ge=0, lt=0.5)]
Stiffness = Annotated[float, reads("stiffness"), Field(ge=0)]
TiltStiffness = Annotated[float, reads("tilt stiffness"), Field(ge=0)]
CrossStiffness = Annotated[float, reads("stiffness")]
Damping = Annotated[float, reads("damping"), Field(ge=0)]
CrossDamping = Annotated[float, reads("damping")]
UnbalanceAmount = Annotated[float, reads("unbalance"), Field(ge=0)]
Angle = Annotated[float, reads("angle")]
Speed = Annotated[float, reads("speed"), Field(gt=0)]
TableSpeed = Annotated[float, reads("speed"), Field(ge=0)]
RampRate = Annotated[float, reads("ramp"), Field(gt=0)]
Time = Annotated[float, reads("time"), Field(gt=0)]
Voltage = Annotated[float, reads("voltage")]
Sensitivity = Annotated[float, reads("sensitivity"), Field(gt=0)]
Rate = Annotated[float, reads("rate"), Field(gt=0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Tube:
    """A stretch of shaft of one cross-section and one material, SI."""

    start: float  # m from the coupling
    length: float
    diameter: float
    inner_diameter: float
    density: float
    youngs_modulus: float
    poisson_ratio: float

    @property
    def end(self) -> float:
        """Position of its end, m from the coupling."""
        return self.start + self.length


class Rayleigh(Part):
    """Proportional damping of the bare shaft, C = mass * M + stiffness * K; it does not rotate with it."""

    mass: Annotated[float, reads("damping rate"), Field(ge=0)] = 0.0  # share of the mass matrix
    stiffness: Annotated[float, reads("time"), Field(ge=0)] = 0.0  # share of the stiffness matrix


class Section(Part):
    """A section of a stepped shaft; its material defaults to the shaft's."""

    length: Length  # along the shaft
    diameter: Length  # outer
    inner_diameter: Position = 0.0  # of the bore; 0: solid
    density: Density | None = None  # default: the shaft's
    youngs_modulus: Modulus | None = None  # default: the shaft's
    poisson_ratio: PoissonRatio | None = None  # default: the shaft's

    @model_validator(mode="after")
    def _is_a_tube(self) -> Self:
        _check_bore(self.inner_diameter, self.diameter)
        if self.length <= SHORTEST:
            raise ValueError(f"length {self.length * 1e6:g} um, want more than {SHORTEST * 1e6:g} um")
        return self


def _total_length(given: dict[str, Any]) -> float:
    return sum(section.length for section in given.get("sections", ()))


def _largest_diameter(given: dict[str, Any]) -> float:
    return max((section.diameter for section in given.get("sections", ())), default=0.0)


class Shaft(Part):
    """The shaft: uniform, or in `sections` from the coupling, which then give length and diameter."""

    sections: tuple[Section, ...] = Field((), max_length=MOST)  # of a stepped shaft, in order from the coupling
    length: Length = Field(default_factory=_total_length)  # from end to end; of a stepped shaft: the sum
    diameter: Length = Field(default_factory=_largest_diameter)  # outer; of a stepped shaft: the largest
    inner_diameter: Position = 0.0  # of the bore; 0: solid
    density: Density
    youngs_modulus: Modulus
    poisson_ratio: PoissonRatio = 0.3  # for the shear deflection
    rayleigh: Rayleigh = Rayleigh()  # damping of the bare shaft
    structural_damping: float = Field(0.0, ge=0, lt=1)  # loss factor eta: K (1 + j eta), does not rotate with the shaft

    @property
    def tubes(self) -> tuple[Tube, ...]:
        """The stretches of constant cross-section and material, from the coupling."""
        tubes: list[Tube] = []
        for section in self.sections or (self,):
            tubes.append(
                Tube(
                    start=tubes[-1].end if tubes else 0.0,
                    length=section.length,
                    diameter=section.diameter,
                    inner_diameter=section.inner_diameter,
                    density=section.density or self.density,
                    youngs_modulus=section.youngs_modulus or self.youngs_modulus,
                    poisson_ratio=self.poisson_ratio if section.poisson_ratio is None else section.poisson_ratio,
                )
            )
        return tuple(tubes)

    def tube_at(self, position: float) -> Tube:
        """Return the stretch at a position [m]; at a step the one behind it."""
        tubes = self.tubes
        return next((tube for tube in tubes if position < tube.end), tubes[-1])

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        for name in ("length", "diameter"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is missing, want it, or the shaft in sections")
        if self.length > LONGEST_SHAFT:
            raise ValueError(
                f"length {self.length:g} m, want at most {LONGEST_SHAFT:g} m: the model has 50 elements per m"
            )
        if self.sections:
            self._check_sections()
        else:
            _check_bore(self.inner_diameter, self.diameter)
        return self

    def _check_sections(self) -> None:
        given = {"sections": self.sections}
        for name, want in (("length", _total_length(given)), ("diameter", _largest_diameter(given))):
            if abs(got := getattr(self, name) - want) > AGREE:
                kind = "sum" if name == "length" else "largest"
                raise ValueError(
                    f"{name} {(want + got) * 1e3:g} mm, but the sections' {kind} is {want * 1e3:g} mm; "
                    f"want it to agree or be left out"
                )
        if self.inner_diameter:
            raise ValueError("inner_diameter stands beside sections, want it in each section that is hollow")


def _check_bore(inner: float, outer: float) -> None:
    if inner >= outer:
        raise ValueError(f"inner_diameter {inner * 1e3:g} mm, want less than the {outer * 1e3:g} mm diameter")


class Unbalance(Part):
    """An unbalance: its amount and its angle from the keyphasor mark."""

    amount: UnbalanceAmount  # mass times radius
    angle: Angle = 0.0  # from the keyphasor mark, in the sense of rotation


def is_none(value: float | None) -> bool:
    """Return whether a value is left out of what is hashed: a config without the key keeps the hash it had before."""
    return value is None


def is_zero(value: float) -> bool:
    """Return whether a value is left out of what is hashed, as by `is_none`."""
    return value == 0


class Disk(Part):
    """A rigid disk, with the unbalance expected of it."""

    name: Name  # of your choice, unique
    position: Position  # of its middle, from the coupling end of the shaft
    mass: Mass
    polar_inertia: Inertia  # about the shaft
    transverse_inertia: Inertia  # about a diameter, through its middle
    width: Length = 0.025  # for the drawing only
    diameter: Length = 0.075  # for the drawing only
    #: along the shaft, of what may stiffen it (`prior.hub`); default: 2.5 shaft diameters
    hub_width: Length | None = Field(None, exclude_if=is_none)
    unbalance: Unbalance | None = None  # as expected: initial guess of a fit, and unbalance of the simulated rig


class Plane(Part):
    """A massless plane on the shaft for unbalance or a force: a coupling, a balance ring, a journal."""

    name: Name  # of your choice, not that of a disk
    position: Position  # from the coupling end of the shaft


class OverSpeed(Part):
    """A bearing coefficient over shaft speed: linear between the speeds, constant outside them."""

    speed: tuple[TableSpeed, ...] = Field(min_length=2)  # ascending
    value: tuple[float, ...]  # of the coefficient, one per speed

    @model_validator(mode="after")
    def _is_a_table(self) -> Self:
        if len(self.speed) != len(self.value):
            raise ValueError(f"{len(self.speed)} speeds and {len(self.value)} values, want one value for every speed")
        if not all(a < b for a, b in pairwise(self.speed)):
            raise ValueError("the speeds do not rise from each to the next, want them in order")
        return self


class StiffnessOverSpeed(OverSpeed):
    """A direct stiffness over shaft speed."""

    value: tuple[Stiffness, ...]  # one per speed


class CrossStiffnessOverSpeed(OverSpeed):
    """A cross stiffness over shaft speed."""

    value: tuple[CrossStiffness, ...]  # one per speed


class DampingOverSpeed(OverSpeed):
    """A direct damping over shaft speed."""

    value: tuple[Damping, ...]  # one per speed


class CrossDampingOverSpeed(OverSpeed):
    """A cross damping over shaft speed."""

    value: tuple[CrossDamping, ...]  # one per speed


def _form(value: object) -> str:
    return TABLE if isinstance(value, Mapping | BaseModel) else NUMBER


_EITHER = Discriminator(_form)
DirectK = Annotated[Annotated[Stiffness, Tag(NUMBER)] | Annotated[StiffnessOverSpeed, Tag(TABLE)], _EITHER]
CrossK = Annotated[Annotated[CrossStiffness, Tag(NUMBER)] | Annotated[CrossStiffnessOverSpeed, Tag(TABLE)], _EITHER]
DirectC = Annotated[Annotated[Damping, Tag(NUMBER)] | Annotated[DampingOverSpeed, Tag(TABLE)], _EITHER]
CrossC = Annotated[Annotated[CrossDamping, Tag(NUMBER)] | Annotated[CrossDampingOverSpeed, Tag(TABLE)], _EITHER]


class Bearing(Part):
    """Eight linear coefficients between shaft and ground, [N/m] and [N s/m], each constant or over speed.

    A `rigid` one has none and holds the shaft at x = y = 0, free to tilt but for `tilt_stiffness`. x and y are the
    probes' axes.
    """

    name: Name  # of your choice, unique
    position: Position  # from the coupling end of the shaft
    rigid: bool = False  # x = y = 0 exactly, free to tilt
    kxx: DirectK | None = None  # force along x per deflection along x
    kyy: DirectK | None = None  # force along y per deflection along y
    kxy: CrossK = 0.0  # force along x per deflection along y
    kyx: CrossK = 0.0  # force along y per deflection along x
    cxx: DirectC = 0.0  # force along x per velocity along x
    cyy: DirectC = 0.0  # force along y per velocity along y
    cxy: CrossC = 0.0  # force along x per velocity along y
    cyx: CrossC = 0.0  # force along y per velocity along x
    tilt_stiffness: TiltStiffness = Field(
        0.0, exclude_if=is_zero
    )  # moment against the shaft's tilt in it, alike in x, y
    clearance: Length | None = Field(None, exclude_if=is_none)  # diametral; drawn as a circle about the centreline

    @property
    def over_speed(self) -> bool:
        """True if any coefficient depends on the speed."""
        return any(isinstance(getattr(self, name), OverSpeed) for name in COEFFICIENTS)

    def constant(self, name: str) -> float:
        """Return a coefficient that is a number. Raises ConfigError, in one sentence, if it is none."""
        value = getattr(self, name)
        if isinstance(value, OverSpeed):
            raise ConfigError(f"bearing '{self.name}': {name} depends on speed, want a constant for this")
        if value is None:
            raise ConfigError(f"bearing '{self.name}': is rigid, want {name} and the other coefficients for this")
        return float(value)

    @model_validator(mode="after")
    def _is_held_one_way(self) -> Self:
        if self.rigid:
            given = [name for name in COEFFICIENTS if getattr(self, name)]
            if given:
                raise ValueError(f"'{self.name}' is rigid and has {given[0]}, want one or the other")
            return self
        for name in ("kxx", "kyy"):
            if getattr(self, name) is None:
                raise ValueError(f"'{self.name}' has no {name}, want a stiffness such as '33.9 kN/m', or rigid = true")
        return self


class Probe(Part):
    """A proximity probe: volts rise as the shaft comes nearer; `angle` is where it sits, from +x towards +y."""

    name: str = Field(pattern=r"^[A-Za-z0-9_.-]+$", max_length=LONGEST_PROBE)  # of your choice: letters, digits, _ . -
    position: Position  # from the coupling end of the shaft
    angle: Angle  # where it sits about the shaft, from +x towards +y
    channel: int = Field(ge=0, lt=MOST_CHANNELS)  # input of the DAQ, from 0
    sensitivity: Sensitivity = 7874.0  # 200 mV/mil; divided down if a divider is in the way
    gap_voltage: Voltage = -10.0  # of its driver with the shaft at rest: displacement 0
    linear_range: tuple[Voltage, Voltage] = (-18.0, -2.0)  # an 8 mm probe's 80 mil about -10 V

    @field_validator("name")
    @classmethod
    def _is_free(cls, name: str) -> str:
        if name.casefold() in TAKEN or not name.strip("."):
            raise ValueError(f"got '{name}', which names something else; want another name, such as '1x'")
        return name
