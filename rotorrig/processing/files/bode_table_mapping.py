"""Mapping of a Bode table's columns to speeds and vectors: a small TOML file beside the CSV.

compensated = true              # a slow-roll vector was subtracted from every row: say which one in [slow_roll]

[speed]
column = "rpm"
unit = "1 rpm"                  # what a 1 in the column stands for

[[vectors]]
probe = "1x"                    # of the rig's config
amplitude = "amp"               # columns: amplitude and phase, or real and imaginary with conjugated
phase = "phase"
unit = "1 um"                   # what a 1 in the column stands for: any length, velocity or acceleration
amplitude_is = "0-peak"         # or "peak-to-peak", "rms"
phase_is = "lag"                # or "phase": arg z; x = Re(z exp(j theta))
phase_unit = "1 deg"
# conjugated = true             # of real and imaginary alone: x = Re(z exp(-j theta)), as re + j im = A exp(j lag)

[[runs]]
name = "up"
direction = "up"                # or "down", "dwell"
ramp = "30 rpm/s"               # of a moving speed, with revolutions = 8 of a row; or rows = "one per revolution"
trial = [{ disk = "disk", amount = "12 g mm", angle = "90 deg" }]

[[trial_columns]]               # trial masses that stand in the table
plane_column = "plane"          # or plane = "disk", where it is the same in every row
amount = "mass"
amount_unit = "1 g mm"
angle = "at"
angle_unit = "1 deg"

[uncertainty]                   # left out: estimated from the scatter of the data
absolute = "0.5 um"
relative = 0.02

Vectors without a phase, all of them, make a response of amplitudes alone.
"""

from typing import Annotated, Literal

from rotorrig.rig.config import (
    Angle,
    Length,
    Part,
    RampRate,
    Speed,
    TrialMass,
    UnbalanceAmount,
    reads_one_of,
)

SLOW_ROLL = "slow roll"  # name of the run that is one
VIBRATIONS = ("length", "velocity", "acceleration")  # by how often it is differentiated
DIRECTIONS = {"up": 1, "down": -1, "dwell": 0}


#: what a 1 stands for in SI, and whether that is a displacement or a derivative of it by time
Vibration = Annotated[tuple[float, str], reads_one_of(*VIBRATIONS)]


class SpeedColumn(Part):
    """Column of the speed."""

    column: str
    unit: Speed


class VectorColumns(Part):
    """Columns of the vector of a probe at an order."""

    probe: str
    order: float = 1.0
    amplitude: str | None = None
    phase: str | None = None
    real: str | None = None
    imaginary: str | None = None
    unit: Vibration
    amplitude_is: Literal["0-peak", "peak-to-peak", "rms"] = "0-peak"
    phase_is: Literal["phase", "lag"] | None = None
    phase_unit: Angle | None = None
    conjugated: bool | None = None

    @property
    def columns(self) -> tuple[str, ...]:
        """The two columns, whichever form they take; the amplitude's alone where there is no phase."""
        pair = (self.amplitude, self.phase) if self.amplitude is not None else (self.real, self.imaginary)
        return tuple(column for column in pair if column is not None)


class TableRun(Part):
    """A passage of the rotor: all rows, or those with `value` in the run column."""

    name: str
    direction: Literal["up", "down", "dwell"]
    value: str | None = None
    ramp: RampRate | None = None
    rows: Literal["one per revolution"] | None = None
    revolutions: float | None = None
    trial: tuple[TrialMass, ...] = ()


class TrialColumns(Part):
    """Columns of a trial mass, the same in all rows of a passage; without an amount, or with 0, there is none."""

    plane: str | None = None  # disk or plane of the config that it is on
    plane_column: str | None = None  # or the column with its name
    amount: str
    amount_unit: UnbalanceAmount
    angle: str
    angle_unit: Angle

    @property
    def columns(self) -> tuple[str, ...]:
        """All columns."""
        return (*([self.plane_column] if self.plane_column is not None else []), self.amount, self.angle)


class StatedVector(Part):
    """A slow-roll vector as stated: 0-peak, `phase` is arg z."""

    probe: str
    order: float = 1.0
    amplitude: Length
    phase: Angle


class StatedSlowRoll(Part):
    """The slow roll of a table without rows of it; of a compensated one what was subtracted, or its speed alone."""

    speed: Speed
    vectors: tuple[StatedVector, ...] = ()


class Uncertainty(Part):
    """One standard deviation of a vector's real or imaginary part; both kinds add in squares."""

    absolute: Vibration | None = None
    relative: float = 0.0


class TableMapping(Part):
    """All of a mapping file."""

    notes: str = ""
    delimiter: str = ","
    run_column: str | None = None
    compensated: bool | None = None
    window: Literal["rectangular", "hann", "blackman"] = "rectangular"
    speed: SpeedColumn
    vectors: tuple[VectorColumns, ...]
    runs: tuple[TableRun, ...]
    trial_columns: tuple[TrialColumns, ...] = ()
    slow_roll: StatedSlowRoll | None = None
    uncertainty: Uncertainty | None = None

    @property
    def amplitudes_alone(self) -> bool:
        """Whether no vector has a phase."""
        return all(vector.real is None and vector.phase is None for vector in self.vectors)

    @property
    def columns(self) -> tuple[str, ...]:
        """All columns that are read."""
        vectors = [column for vector in self.vectors for column in vector.columns]
        trials = [column for trial in self.trial_columns for column in trial.columns]
        named = (self.speed.column, *vectors, *trials)
        return (*named, self.run_column) if self.run_column is not None else named
