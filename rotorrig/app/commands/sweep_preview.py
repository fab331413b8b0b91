"""`rotor sweep --dry-run`: steps, limits and objections of a sweep; no device is opened."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from rotorrig.acquisition.sweep import (
    COAST_SECONDS,
    Ask,
    Band,
    Coast,
    Dwell,
    Mark,
    Provoke,
    Ramp,
    Rest,
    TimedStep,
    Trial,
    critical_bands,
    draft_sweep,
    objections,
    plan_timeline,
)
from rotorrig.app.commands.config_model import criticals_of
from rotorrig.app.terminal import out, tell
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.interlock import overspeed_limit
from rotorrig.rig.probes import channels_used

BYTES_PER_SAMPLE = 2  # and channel, before compression
COMPRESSION = 0.5  # of a rotor's vibration: a quiet one less, a noisy one up to 0.7
ROWS = 10  # of the chart
BLOCKS = " ▁▂▃▄▅▆▇█"
PLAIN = " .::-==##"
DOT = {False: "·", True: "."}  # along a critical speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Preview:
    """Steps, critical speeds and objections of a plan."""

    steps: tuple[TimedStep, ...]
    criticals: tuple[float, ...]  # of the nameplate's model, rad/s
    bands: tuple[Band, ...]
    objections: tuple[str, ...]  # reasons to refuse it

    @property
    def seconds(self) -> float:
        """Duration [s], without the time for mounting trial masses."""
        return self.steps[-1].end if self.steps else 0.0


def preview_plan(rig: RigConfig, plan: str, *, trial: Sequence[str] = (), speeds: Sequence[float] = ()) -> Preview:
    """Return the preview of a plan. Raises ConfigError for an unknown plan or trial mass."""
    criticals = criticals_of(rig)
    steps = draft_sweep(rig, plan, trial=trial, speeds=speeds, criticals=criticals)
    return Preview(
        steps=plan_timeline(steps),
        criticals=tuple(criticals),
        bands=critical_bands(rig.limits, criticals),
        objections=tuple(objections(rig, steps, criticals=criticals)),
    )


def show(
    rig: RigConfig,
    plan: str,
    *,
    trial: Sequence[str] = (),
    speeds: Sequence[float] = (),
    as_json: bool = False,
) -> None:
    """Print the preview, then raise ConfigError with the first objection."""
    preview = preview_plan(rig, plan, trial=trial, speeds=speeds)
    if as_json:
        tell("", preview_facts(rig, plan, preview), as_json=True)
    else:
        _print(rig, plan, preview)
    for objection in preview.objections:
        raise ConfigError(f"plans.{plan}: {objection}")


def preview_facts(rig: RigConfig, plan: str, preview: Preview) -> dict[str, Any]:
    """Return the preview as plain values in s, rpm and bytes."""
    return {
        "plan": plan,
        "seconds": preview.seconds,
        "bytes": estimate_bytes(rig, preview.seconds),
        "critical_speeds_rpm": [speed * RPM for speed in preview.criticals],
        "objections": list(preview.objections),
        "steps": [
            {
                "begin_s": timed.begin,
                "end_s": timed.end,
                "step": _describe_step(timed)[0],
                "from_rpm": timed.speed * RPM,
                "to_rpm": timed.to * RPM,
                "remarks": _remarks(timed, preview),
            }
            for timed in preview.steps
        ],
    }


def _print(rig: RigConfig, plan: str, preview: Preview) -> None:
    out.print(steps_table(preview, title=f"plan '{plan}' on {rig.name}"))
    plain = out.options.ascii_only or not out.is_terminal
    out.print(chart(preview.steps, criticals=preview.criticals, width=min(out.width, 100), plain=plain))
    for line in (*facts(rig, preview), *(f"refused: {objection}" for objection in preview.objections)):
        out.print(line, highlight=False, markup=False, soft_wrap=True)


def steps_table(preview: Preview, *, title: str) -> Table:
    """Return the steps with times, speeds and the critical speeds they pass."""
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for heading in ("begin, s", "end, s", "step", "rpm", "rpm/s", "remarks"):
        right = heading in ("begin, s", "end, s", "rpm", "rpm/s")
        table.add_column(heading, justify="right" if right else "left", no_wrap=heading != "remarks")
    for timed in preview.steps:
        what, rate = _describe_step(timed)
        speeds = f"{timed.to * RPM:.0f}"
        if timed.to != timed.speed:
            speeds = f"{timed.speed * RPM:.0f} → {speeds}"
        about = "~" if isinstance(timed.step, Coast) else ""
        table.add_row(
            f"{timed.begin:.1f}", f"{about}{timed.end:.1f}", Text(what), speeds, rate, Text(_remarks(timed, preview))
        )
    return table


def facts(rig: RigConfig, preview: Preview) -> list[str]:
    """Return duration, file size, limits and critical speeds, a line each."""
    coasts = sum(isinstance(timed.step, Coast) for timed in preview.steps)
    asks = sum(isinstance(timed.step, Ask) for timed in preview.steps)
    total = f"about {preview.seconds:.0f} s"
    total += f", {coasts} coast-downs assumed to take {COAST_SECONDS:.0f} s each" if coasts > 1 else ""
    total += f", coast-down assumed to take {COAST_SECONDS:.0f} s" if coasts == 1 else ""
    total += f"; plus operator time, asked {'once' if asks == 1 else f'{asks} times'}" if asks else ""
    lines = [f"time: {total}; then run-down to rest"]
    if rig.daq:
        size = estimate_bytes(rig, preview.seconds) / 1e6
        lines.append(f"file: about {size:.0f} MB, {channels_used(rig)} channels at {rig.daq.sample_rate:g} Hz")
    lines.append(f"limits: {limits_words(rig)}")
    named = ", ".join(f"{speed * RPM:.0f}" for speed in preview.criticals) or "none"
    lines.append(f"critical speeds of the nameplate model: {named}{' rpm' if preview.criticals else ''}")
    return lines


def estimate_bytes(rig: RigConfig, seconds: float) -> float:
    """Estimate the size of a sweep's recording; 0 without a DAQ."""
    rate = rig.daq.sample_rate if rig.daq else 0.0
    return seconds * rate * channels_used(rig) * BYTES_PER_SAMPLE * COMPRESSION


def limits_words(rig: RigConfig) -> str:
    """Return the config's limits in a line."""
    limits = rig.limits
    if limits is None:
        speed = overspeed_limit(rig)
        top = f"{speed * RPM:.0f} rpm and " if math.isfinite(speed) else ""
        return f"the config has no [limits]: {top}the probes' linear range"
    words = [f"{limits.overspeed * RPM:.0f} rpm", f"{limits.vibration * 1e6:g} um 0-peak"]
    words += [f"{name} {limit * 1e6:g} um" for name, limit in limits.probes.items()]
    words += [
        f"{band.low * RPM:.0f}-{band.high * RPM:.0f} rpm {band.vibration * 1e6:g} um" for band in limits.critical_bands
    ]
    words += [f"critical speeds passed at {limits.critical_ramp * RPM:g} rpm/s or more"] if limits.critical_ramp else []
    return ", ".join(words)


def chart(steps: Sequence[TimedStep], *, criticals: Sequence[float] = (), width: int, plain: bool) -> Text:
    """Return speed over time as a character chart, labelled with the top speed and the critical speeds [rad/s]."""
    total, top = steps[-1].end or 1.0, max(max(timed.speed, timed.to) for timed in steps) or 1.0
    rows = {int(speed / top * ROWS): f"critical {speed * RPM:.0f} rpm " for speed in criticals if speed < top}
    named = {ROWS - 1: f"{top * RPM:.0f} rpm "} | rows
    margin = max(map(len, named.values()))
    columns = max(width - margin - 1, 20)
    heights = [_speed_at(steps, (i + 0.5) / columns * total) / top * ROWS for i in range(columns)]
    glyphs = PLAIN if plain else BLOCKS
    lines = []
    for row in reversed(range(ROWS)):
        levels = [min(max(height - row, 0.0), 1.0) for height in heights]
        line = "".join(glyphs[math.ceil(level * (len(glyphs) - 1))] for level in levels)
        lines.append(
            named.get(row, "").rjust(margin) + (line.replace(" ", DOT[plain]) if row in rows else line.rstrip())
        )
    end = f"{total:.0f} s"
    lines.append(" " * margin + "0 s" + " " * (columns - 3 - len(end)) + end)
    return Text("\n".join(lines), no_wrap=True, overflow="crop")


def _speed_at(steps: Sequence[TimedStep], t: float) -> float:
    """Return the expected speed at a time, linear within each step."""
    timed = next((timed for timed in steps if timed.begin <= t < timed.end), steps[-1])
    part = (t - timed.begin) / timed.seconds if timed.seconds else 1.0
    return timed.speed + min(part, 1.0) * (timed.to - timed.speed)


def _describe_step(timed: TimedStep) -> tuple[str, str]:
    """Return a step's name, and its rate in rpm/s if it is a ramp."""
    match timed.step:
        case Ramp(rate=rate):
            return "ramp", f"{rate * RPM:.0f}"
        case Dwell():
            return "dwell", ""
        case Coast():
            return "coast, power off", ""
        case Rest():
            return "stop, to rest", ""
        case Ask(request=request):
            return f"ask: {request}", ""
        case Mark(label=label):
            return f"mark '{label}'", ""
        case Trial(mass=mass):
            return f"trial mass: {mass}", ""
        case Provoke(what=what):
            return f"proof test: {what}", ""


def _remarks(timed: TimedStep, preview: Preview) -> str:
    """Return the critical speeds a step passes and the bands it dwells in."""
    low, high = sorted((timed.speed, timed.to))
    remarks = []
    if timed.seconds:
        passed = [f"{speed * RPM:.0f}" for speed in preview.criticals if low <= speed <= high and low < high]
        remarks += [f"passes critical {', '.join(passed)} rpm"] if passed else []
        remarks += [f"in band {band}" for band in preview.bands if timed.speed in band and timed.to in band]
    return "; ".join(remarks)
