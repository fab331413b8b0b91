"""Verbs for data files: replay, track, import, export, salvage."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from rotorrig.app.terminal import err, progress_bars, tell, working
from rotorrig.app.verbs.arguments import (
    OUT,
    AsJson,
    Force,
    LiveUnits,
    Recording,
    Trial,
    View,
    load_config,
    unit_of_view,
)
from rotorrig.app.verbs.output_guard import Arguments, Output
from rotorrig.rig import ConfigError
from rotorrig.rig.config import find_config


def replay(
    run: Recording,
    rate: Annotated[str, typer.Option(help="playback speed: 'max', or recorded seconds per second")] = "max",
    track: Annotated[
        Path | None, typer.Option(help="also track the orders into this response.mcap"), Output(kind="response")
    ] = None,
    begin: Annotated[float, typer.Option("--from", help="start time on the recording's clock, s")] = 0.0,
    view: View = False,
    units: LiveUnits = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Play a recording as if it were live; with --track, track its orders as `rotor track` does."""
    from rotorrig.app.commands import replay

    seconds = replay.play(run, rate=rate, view=view, unit=unit_of_view(units, view=view), track=track, begin=begin)
    words = f"{track or run}: {seconds:.1f} s replayed" + (" and tracked" if track else "")
    tell(words, {"file": str(run), "seconds": seconds, "tracked": str(track) if track else None}, as_json=as_json)


def track(
    run: Recording,
    out_file: Annotated[Path, OUT, Output(kind="response")],
    trial: Trial = None,
    turns: Annotated[int, typer.Option(help="shaft turns per row: more average out more noise, and smear more")] = 8,
    orders: Annotated[str, typer.Option(help="multiples of shaft speed; 0 is the gap")] = "0,0.5,1,2,3",
    method: Annotated[
        Literal["resampling", "least-squares", "vold-kalman"],
        typer.Option(help="windowed DFT over shaft angle; joint fit of all orders; Vold-Kalman filter"),
    ] = "resampling",
    every: Annotated[
        str | None, typer.Option(help="row spacing, '10 rpm' or '0.5 s'", show_default="back to back")
    ] = None,
    slow_roll: Annotated[
        str | None,
        typer.Option(help="slow-roll speed range, '200 to 400 rpm'", show_default="the run named slow-roll"),
    ] = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Track the orders of a recording into a response file, with the slow-roll vector.

    Trial masses are those noted by the sweep, unless --trial replaces them.
    """
    from rotorrig.acquisition.files import open_recording
    from rotorrig.app.text import quality_lines, spacing_remark, tracking_facts, tracking_line
    from rotorrig.processing import Spacing, SpeedWindow, Tracking, pipeline, read_orders
    from rotorrig.processing.files import write_response
    from rotorrig.rig.config import read_trial_mass

    settings = Tracking(
        turns=turns,
        orders=read_orders(orders, where="--orders"),
        method=method,
        every=Spacing.read(every, where="--every") if every else None,
        slow_roll=SpeedWindow.read(slow_roll, where="--slow-roll") if slow_roll else None,
    )
    with open_recording(run) as recording, progress_bars() as bars:
        masses = [read_trial_mass(text, planes=recording.rig.unbalance_planes) for text in trial] if trial else None
        seconds = recording.samples / recording.daq.sample_rate
        task = bars.add_task("tracking", total=1.0, note="", unit="x real time", scale=seconds)
        response = pipeline.track(
            recording, settings, trial=masses, progress=lambda done: bars.update(task, completed=done)
        )
        write_response(out_file, response)
    remarks = [line for line in (spacing_remark(response, settings), *quality_lines(response)) if line]
    facts = {"file": str(out_file), **tracking_facts(response), "said": remarks}
    tell(f"{out_file}: {tracking_line(response)}", facts, as_json=as_json)
    for line in [] if as_json else remarks:
        err.print(line, highlight=False, markup=False, soft_wrap=True)


def _imported_kind(given: Arguments) -> str:
    from rotorrig.app.commands.other_programs import import_files

    return "config" if given["ross"] else import_files.kind_made(given["mapping"])


def _exported_kind(given: Arguments) -> str:
    from rotorrig.app.commands.other_programs import export_files

    return "ross" if given["ross"] else export_files.kind_made(given["out_file"])


def import_(
    file: Annotated[
        Path, typer.Argument(help="CSV, UFF, TDMS or WAV file; with --ross a ROSS rotor", show_default=False)
    ],
    out_file: Annotated[Path, OUT, Output(kind=_imported_kind)],
    config: Annotated[Path | None, typer.Option("--config", help="the rig's TOML file", show_default=False)] = None,
    mapping: Annotated[
        Path | None,
        typer.Option("--mapping", "--vectors", help="TOML file that maps the channels or columns"),
    ] = None,
    ross: Annotated[bool, typer.Option("--ross", help="convert a rotor saved by ROSS to a config")] = False,
    keep_nodes: Annotated[
        bool, typer.Option("--keep-nodes", help="with --ross: one shaft section per element")
    ] = False,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Import waveforms to a run.mcap, a mapped Bode table to a response.mcap or, with --ross, a rotor to a config."""
    from rotorrig.app.commands import other_programs
    from rotorrig.app.commands.other_programs import import_files

    if ross and (config or mapping):
        raise ConfigError("--ross: makes a config, want neither --config nor --mapping")
    if ross:
        lines = other_programs.bring_in(file, out=out_file, keep_nodes=keep_nodes)
    elif config is None:
        raise ConfigError("--config: missing, want the rig's TOML file, which names the columns")
    else:
        with working(f"reading {file.name}"):
            lines = [
                import_files.bring_in(file, rig=load_config(config), mapping=mapping, out=out_file, overwrite=force)
            ]
    tell("\n".join(lines), {"file": str(out_file), "said": lines}, as_json=as_json)


def export(
    file: Annotated[Path, typer.Argument(help="run.mcap or response.mcap; with --ross a config", show_default=False)],
    out_file: Annotated[Path, OUT, Output(kind=_exported_kind)],
    ross: Annotated[bool, typer.Option("--ross", help="export the rotor of a config to ROSS")] = False,
    max_element: Annotated[str, typer.Option(help="with --ross: maximum length of a shaft element")] = "20 mm",
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Export waveforms of a run or order vectors of a response to .csv or .uff; with --ross, a rotor to ROSS.

    For a response, an --out ending in .json writes a Foxglove layout.
    """
    from rotorrig.app.commands.other_programs import export_files

    if ross:
        from rotorrig.app.commands import other_programs

        lines = other_programs.write_out(find_config(file), out=out_file, max_element=max_element)
    else:
        with working(f"writing {out_file.name}"):
            lines = [export_files.write_out(file, out_file)]
    tell("\n".join(lines), {"file": str(out_file), "said": lines}, as_json=as_json)


def salvage(
    run: Recording,
    out_file: Annotated[Path, OUT, Output(kind="run")],
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Recover a valid recording from a truncated one."""
    from dataclasses import asdict

    from rotorrig.acquisition.files import salvage as save

    with working(f"reading {run.name}"):
        saved = save(run, out_file, overwrite=force)
    lost = "nothing lost" if saved.whole else f"{saved.lost_bytes} bytes unreadable"
    words = f"{out_file}: {saved.seconds:.2f} s recovered, {lost}"
    tell(words, {"file": str(out_file), **asdict(saved)}, as_json=as_json)
