"""Mapping of a Bode table's columns to speeds and vectors: a small TOML file beside the CSV, checked.

compensated = true              # a slow-roll vector was subtracted from every row: say which one in [slow_roll]

[speed]
column = "rpm"
unit = "1 rpm"                  # what a 1 in the column stands for

[[vectors]]
probe = "1x"                    # of the rig's config
amplitude = "amp"               # columns: amplitude and phase, or real and imaginary with conjugated
phase = "phase"
unit = "1 um"                   # what a 1 in the column stands for: any length, also "127 um"
amplitude_is = "0-peak"         # or "peak-to-peak", "rms"
phase_is = "lag"                # or "phase": arg z; x = Re(z exp(j theta))
phase_unit = "1 deg"
# conjugated = true             # of real and imaginary alone: x = Re(z exp(-j theta)), as re + j im = A exp(j lag)

[[runs]]
name = "up"
direction = "up"                # or "down", "dwell"
ramp = "30 rpm/s"               # of a moving speed, with revolutions = 8 of a row; or rows = "one per revolution"
trial = [{ disk = "disk", amount = "12 g mm", angle = "90 deg" }]

[uncertainty]                   # left out: estimated from the scatter of the data
absolute = "0.5 um"
relative = 0.02
"""

from pathlib import Path
from typing import Literal

from rotorrig.rig import ConfigError
from rotorrig.rig.config import Angle, Length, Part, RampRate, RigConfig, Speed, TrialMass, read_toml, validate_table

SLOW_ROLL = "slow roll"  # name of the run that is one
TURN = 6.3  # rad, the largest unit of a phase
DIRECTIONS = {"up": 1, "down": -1, "dwell": 0}


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
    unit: Length
    amplitude_is: Literal["0-peak", "peak-to-peak", "rms"] = "0-peak"
    phase_is: Literal["phase", "lag"] | None = None
    phase_unit: Angle | None = None
    conjugated: bool | None = None

    @property
    def columns(self) -> tuple[str, str]:
        """The two columns, whichever form they take."""
        pair = (self.amplitude, self.phase) if self.amplitude is not None else (self.real, self.imaginary)
        return pair[0] or "", pair[1] or ""


class TableRun(Part):
    """A passage of the rotor: all rows, or those with `value` in the run column."""

    name: str
    direction: Literal["up", "down", "dwell"]
    value: str | None = None
    ramp: RampRate | None = None
    rows: Literal["one per revolution"] | None = None
    revolutions: float | None = None
    trial: tuple[TrialMass, ...] = ()


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

    absolute: Length | None = None
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
    slow_roll: StatedSlowRoll | None = None
    uncertainty: Uncertainty | None = None


def load_mapping(path: Path, rig: RigConfig) -> TableMapping:
    """Read and check a mapping against the rig. Raises ConfigError: file, key, got, wanted."""
    table, _ = read_toml(path, want="a mapping")
    mapping = validate_table(TableMapping, table, where=str(path))
    faults = (_vector_fault, _run_fault, _timing_fault, _statement_fault, _compensation_fault)
    for fault in (find(mapping, rig) for find in faults):
        if fault:
            raise ConfigError(f"{path}: {fault}")
    return mapping


def _vector_fault(mapping: TableMapping, rig: RigConfig) -> str:
    """Return what is wrong with the vectors, empty if nothing."""
    if not mapping.vectors:
        return "vectors: is empty, want a [[vectors]] table for every probe"
    names = [probe.name for probe in rig.probes]
    seen: set[tuple[str, float]] = set()
    for i, vector in enumerate(mapping.vectors):
        key = f"vectors[{i}]"
        polar, cartesian = (vector.amplitude, vector.phase), (vector.real, vector.imaginary)
        if vector.probe not in names:
            return f"{key}.probe: the config has no probe '{vector.probe}', want one of {names}"
        if (vector.probe, vector.order) in seen:
            return f"{key}: probe '{vector.probe}' at order {vector.order:g} is there twice, want it once"
        if sorted(pair.count(None) for pair in (polar, cartesian)) != [0, 2]:
            return f"{key}: want the columns amplitude and phase, or real and imaginary"
        if fault := _sign_fault(vector):
            return f"{key}.{fault}"
        if vector.phase_unit is not None and not 0 < vector.phase_unit <= TURN:
            return f"{key}.phase_unit: got {vector.phase_unit:g} rad, want what a 1 stands for, such as '1 deg'"
        seen.add((vector.probe, vector.order))
    return ""


def _sign_fault(vector: VectorColumns) -> str:
    """Return what is wrong with the keys that say which way angles count, empty if nothing."""
    if vector.amplitude is not None:
        if vector.conjugated is not None:
            return 'conjugated: has no meaning for amplitude and phase, want phase_is = "phase" or "lag" alone'
        if vector.phase_is is None or vector.phase_unit is None:
            return 'phase: want phase_is = "phase" or "lag", and phase_unit = "1 deg" or "1 rad"'
        return ""
    for name in ("phase_is", "phase_unit"):
        if getattr(vector, name) is not None:
            return (
                f"{name}: has no meaning for real and imaginary, want conjugated = true where they are those of "
                "x = Re(z exp(-j theta)), as re + j im = A exp(j lag), or else nothing"
            )
    return ""


def _run_fault(mapping: TableMapping, rig: RigConfig) -> str:
    """Return what is wrong with the runs, empty if nothing."""
    if not mapping.runs:
        return "runs: is empty, want a [[runs]] table for every run"
    names = [run.name for run in mapping.runs]
    for name in names:
        if names.count(name) > 1:
            return f"runs: two are named '{name}', want different names"
    for i, run in enumerate(mapping.runs):
        key = f"runs[{i}]"
        if len(mapping.runs) > 1 and (run.value is None or mapping.run_column is None):
            return f"{key}: of several runs each needs its value in the run_column, and run_column its name"
        if run.rows and run.revolutions not in (None, 1.0):
            return f"{key}.revolutions: got {run.revolutions:g}, but rows are one per revolution"
        if run.revolutions is not None and run.revolutions <= 0:
            return f"{key}.revolutions: got {run.revolutions:g}, want more than 0"
        for trial in run.trial:
            if trial.disk not in (disks := [disk.name for disk in rig.disks]):
                return f"{key}.trial: the config has no disk '{trial.disk}', want one of {disks}"
    return ""


def _timing_fault(mapping: TableMapping, rig: RigConfig) -> str:
    """Return what is wrong with ramps and revolutions, empty if nothing."""
    for i, run in enumerate(mapping.runs):
        if run.ramp is None:
            continue
        key = f"runs[{i}].ramp"
        if run.direction == "dwell":
            return f"{key}: a dwell has none, want direction up or down, or no ramp"
        if run.rows:
            return f"{key}: rows are one per revolution and tell the times, want one of the two"
    moving = [run for run in mapping.runs if run.name != SLOW_ROLL]
    timed = [run for run in moving if run.ramp is not None or run.rows]
    for run in moving if timed else ():
        if run not in timed:
            return (
                f"runs: '{timed[0].name}' has a ramp or a row per revolution and '{run.name}' has not, want that of "
                "every run, as the model follows the speed through all of a table or takes all as steady; leave it out "
                "everywhere or put them into tables of their own"
            )
    return ""


def _compensation_fault(mapping: TableMapping, rig: RigConfig) -> str:
    """Return what is wrong with what was subtracted, empty if nothing."""
    stated = mapping.slow_roll
    if not mapping.compensated:
        if stated and not stated.vectors:
            return "slow_roll.vectors: is empty, want its vectors; the speed alone will do where compensated = true"
        return ""
    if stated is None:
        if any(run.name == SLOW_ROLL for run in mapping.runs):
            return ""
        return (
            "compensated: want the vectors that were subtracted in [slow_roll], or, where nobody kept them, the speed "
            'they were taken at: [slow_roll] with speed = "240 rpm" alone'
        )
    here = {(vector.probe, vector.order) for vector in stated.vectors}
    for vector in mapping.vectors if stated.vectors else ():
        if (vector.probe, vector.order) not in here:
            return (
                f"slow_roll: probe '{vector.probe}' at order {vector.order:g} is missing, want what was subtracted "
                "from every vector, or the speed alone"
            )
    return ""


def _statement_fault(mapping: TableMapping, rig: RigConfig) -> str:
    """Return what is wrong with the uncertainty, the slow roll or the delimiter, empty if nothing."""
    if len(mapping.delimiter) != 1:
        return f"delimiter: got {mapping.delimiter!r}, want one character"
    stated = mapping.uncertainty
    if stated and (stated.relative < 0 or (stated.absolute is None and stated.relative == 0)):
        return "uncertainty: want absolute with its unit, relative above 0, or both"
    if stated and not ((stated.absolute or 0.0) <= 1.0 and stated.relative <= 10.0):
        return "uncertainty: want absolute of less than 1 m, relative of less than 10 (it is no percentage)"
    here = {(vector.probe, vector.order) for vector in mapping.vectors}
    for vector in mapping.slow_roll.vectors if mapping.slow_roll else ():
        if (vector.probe, vector.order) not in here:
            return f"slow_roll: probe '{vector.probe}' at order {vector.order:g} is not among the vectors"
    return ""
