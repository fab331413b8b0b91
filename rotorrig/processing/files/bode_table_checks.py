"""Reading of a Bode table's mapping, and what may be wrong with it: key, got, wanted."""

from pathlib import Path

from rotorrig.processing.files.bode_table_mapping import SLOW_ROLL, TableMapping, VectorColumns
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RigConfig, read_toml, validate_table

TURN = 6.3  # rad, the largest unit of a phase


def load_mapping(path: Path, rig: RigConfig) -> TableMapping:
    """Read and check a mapping against the rig. Raises ConfigError: file, key, got, wanted."""
    table, _ = read_toml(path, want="a mapping")
    mapping = validate_table(TableMapping, table, where=str(path))
    faults = (
        _vector_fault,
        _phase_fault,
        _run_fault,
        _trial_fault,
        _timing_fault,
        _statement_fault,
        _compensation_fault,
    )
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
        told = vector.phase_is is not None or vector.phase_unit is not None
        alone = vector.amplitude is not None and vector.phase is None and cartesian == (None, None) and not told
        if sorted(pair.count(None) for pair in (polar, cartesian)) != [0, 2] and not alone:
            return f"{key}: want the columns amplitude and phase, or real and imaginary, or amplitude alone"
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
        if vector.phase is None:
            return ""
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


def _phase_fault(mapping: TableMapping, rig: RigConfig) -> str:
    """Return what is wrong with vectors without a phase, empty if nothing."""
    for i, vector in enumerate(mapping.vectors):
        if vector.unit[1] != "length" and vector.order == 0:
            return f"vectors[{i}].unit: a mean position has no velocity or acceleration, want a length"
        if vector.amplitude is not None and vector.phase is None and not mapping.amplitudes_alone:
            return f"vectors[{i}]: has an amplitude alone and others have a phase, want that of all or of none"
    if not mapping.amplitudes_alone:
        return ""
    if mapping.slow_roll is not None and mapping.slow_roll.vectors:
        return "slow_roll.vectors: cannot be told from amplitudes alone, want phases too; or the speed alone"
    if any(run.name == SLOW_ROLL for run in mapping.runs):
        return f"runs: a '{SLOW_ROLL}' is a vector, want phases too; or other names, where amplitudes are all there is"
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
            if trial.disk not in rig.unbalance_planes:
                planes = list(rig.unbalance_planes)
                return f"{key}.trial: the config has no disk or plane '{trial.disk}', want one of {planes}"
    return ""


def _trial_fault(mapping: TableMapping, rig: RigConfig) -> str:
    """Return what is wrong with the columns of trial masses, empty if nothing."""
    for i, trial in enumerate(mapping.trial_columns):
        key = f"trial_columns[{i}]"
        if (trial.plane is None) == (trial.plane_column is None):
            return f"{key}: want plane, a disk or plane of the config, or plane_column, the column of its name"
        if trial.plane is not None and trial.plane not in rig.unbalance_planes:
            planes = list(rig.unbalance_planes)
            return f"{key}.plane: the config has no disk or plane '{trial.plane}', want one of {planes}"
        if not trial.amount_unit > 0:
            return f"{key}.amount_unit: got 0, want what a 1 stands for, such as '1 g mm'"
        if not 0 < trial.angle_unit <= TURN:
            return f"{key}.angle_unit: got {trial.angle_unit:g} rad, want what a 1 stands for, such as '1 deg'"
    for run in mapping.runs if mapping.trial_columns else ():
        if run.trial:
            return f"runs: '{run.name}' has a trial beside trial_columns, want one of the two"
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
    scale, quantity = stated.absolute if stated and stated.absolute else (0.0, "length")
    if stated and not ((scale <= 1.0 or quantity != "length") and stated.relative <= 10.0):
        return "uncertainty: want absolute of less than 1 m, relative of less than 10 (it is no percentage)"
    here = {(vector.probe, vector.order) for vector in mapping.vectors}
    for vector in mapping.slow_roll.vectors if mapping.slow_roll else ():
        if (vector.probe, vector.order) not in here:
            return f"slow_roll: probe '{vector.probe}' at order {vector.order:g} is not among the vectors"
    return ""
