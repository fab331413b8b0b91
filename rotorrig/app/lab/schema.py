"""Schema of a lab's catalogue: its tables, and of every column its type, meaning and unit.

Columns may be added at the end; none changes its name, type or unit. A part-file that lacks a column has null there.
"""

import pyarrow as pa

UTC_TIME = pa.timestamp("us", tz="UTC")


def _column(name: str, kind: pa.DataType, description: str, *, unit: str = "", nullable: bool = False) -> pa.Field:
    metadata = {"description": description, "unit": unit}
    return pa.field(name, kind, nullable=nullable, metadata=metadata)


def _text(name: str, description: str, *, nullable: bool = False) -> pa.Field:
    return _column(name, pa.string(), description, nullable=nullable)


def _number(name: str, description: str, *, unit: str = "", nullable: bool = True) -> pa.Field:
    return _column(name, pa.float64(), description, unit=unit, nullable=nullable)


def _whole(name: str, description: str, *, nullable: bool = False) -> pa.Field:
    return _column(name, pa.int64(), description, nullable=nullable)


#: of every table: which recording, and which computation of it
KEYS = (
    _text("run_id", "the recording: first 16 hex digits of the SHA-256 of its bytes"),
    _text("key", "the computation: 16 hex digits of the SHA-256 of run_id, config, code version, steps and settings"),
    _text("code_version", "of the program, with its commit in a checkout"),
    _column("made_at", UTC_TIME, "when the computation ended"),
)
RUNS = pa.schema(
    [
        *KEYS,
        _text("file", "relative to the lab's folder, with '/'"),
        _column(
            "recorded_at",
            UTC_TIME,
            "begin of the recording if it says so, else the file's time of modification",
            nullable=True,
        ),
        _text("rig", "name in the config; '' if it cannot be read"),
        _text("nameplate_hash", "of the config without its effects; '' if it cannot be read"),
        _text("config_hash", "of the config in use; '' if it cannot be read"),
        _text("kind", "'run' or 'response'"),
        _number("duration_s", "from the first row to the last; of a recording, of all its samples", unit="s"),
        _number("lowest_speed_rpm", "of all rows", unit="rpm"),
        _number("highest_speed_rpm", "of all rows", unit="rpm"),
        _whole("rows", "of the response", nullable=True),
        _whole("probes", "of the response", nullable=True),
        _text("status", "'done' or 'failed'"),
        _text("step", "last step that was done: 'track', 'identify', 'diagnose', 'report'; '' if none was"),
        _text("sentence", "of a failure what was wrong; else the verdict's sentence; '' if not diagnosed"),
        _text(
            "verdict",
            "'adequate', 'named', 'tied', 'described', 'unexplained' or 'cannot tell'; '' if not diagnosed",
        ),
        _number("chi2_per_dof", "of the fit of the whole sweep, else of the diagnosis's base model"),
        _number("residual_um", "rms of 1X as measured less as fitted, over usable rows and probes, 0-peak", unit="µm"),
        _number("noise_um", "median over usable rows of one standard deviation of a 1X component", unit="µm"),
        _number("seconds_track", "null if not made in this computation", unit="s"),
        _number("seconds_identify", "null if not made in this computation", unit="s"),
        _number("seconds_diagnose", "null if not made in this computation", unit="s"),
        _text("response_file", "relative to the lab's folder", nullable=True),
        _text("fit_file", "relative to the lab's folder", nullable=True),
        _text("diagnosis_file", "relative to the lab's folder", nullable=True),
        _text("report_file", "relative to the lab's folder", nullable=True),
    ]
)
ESTIMATES = pa.schema(
    [
        *KEYS,
        _text("fit", "'whole sweep', or the band's name in the config"),
        _text("name", "'kxx', 'spring kxx', 'u', 'phase'; see docs/results.md"),
        _number("value", "as identified", unit="see column unit", nullable=False),
        _number("sigma", "one standard deviation; infinite if undetermined", unit="see column unit", nullable=False),
        _number("low95", "lower end of the 95 % interval; null without one", unit="see column unit"),
        _number("high95", "upper end of the 95 % interval; null without one", unit="see column unit"),
        _text("unit", "SI: 'N/m', 'N s/m', 'kg m', 'rad', '' of a ratio"),
        _number("nameplate", "of the config; null if it does not say", unit="see column unit"),
        _column("determined", pa.bool_(), "false at a bound, or where the data hardly restrict it"),
    ]
)
CAUSES = pa.schema(
    [
        *KEYS,
        _whole("rank", "1 is the first: those in the model, then by evidence"),
        _text("label", "effect and place: 'runout, plane 2'"),
        _text("effect", "its name in docs/effects.md, or of a statement of the config"),
        _text("place", "'' where there is one only"),
        _column("chosen", pa.bool_(), "it is in the extended model"),
        _number("evidence", "BIC without less BIC with it; above 0 speaks for it"),
        _number("explained", "part of the base model's chi2 above dof, 0 to 1; null if chi2 is within its scatter"),
        _text("words", "one sentence with the size"),
    ]
)
PEAKS = pa.schema(
    [
        *KEYS,
        _text("run", "within the recording: 'up', 'down'"),
        _text("probe", "its name in the config"),
        _number("critical_speed_rpm", "where 1X is the largest", unit="rpm", nullable=False),
        _number("peak_um", "1X there, 0-peak, slow roll subtracted if known", unit="µm", nullable=False),
        _number("amplification_factor", "Nc / (N2 - N1) of the half-power speeds; null if a run lacks one"),
        _number("damping_ratio", "1 / (2 amplification factor); null likewise"),
    ]
)
EVENTS = pa.schema(
    [
        *KEYS,
        _number("t_s", "on the recording's sample clock", unit="s", nullable=False),
        _text("kind", "'mark', 'trial', 'gap', 'trip' and others; see docs/files.md"),
        _text("text", "as the sweep noted it"),
    ]
)
TABLES: dict[str, pa.Schema] = {
    "runs": RUNS,
    "estimates": ESTIMATES,
    "causes": CAUSES,
    "peaks": PEAKS,
    "events": EVENTS,
}
