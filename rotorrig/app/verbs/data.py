"""Verbs for files of data: replay, track, import, export, salvage."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from rotorrig.app.terminal import err, progress_bars, tell, working
from rotorrig.app.verbs.arguments import AsJson, Out, Recording, Trial, View, load_config
from rotorrig.rig import ConfigError
from rotorrig.rig.config import find_config


def replay(
    run: Recording,
    rate: Annotated[str, typer.Option(help="'max', or recorded seconds per second")] = "max",
    track: Annotated[Path | None, typer.Option(help="the response.mcap to write, of what was played")] = None,
    begin: Annotated[float, typer.Option("--from", help="seconds on the recording's clock to begin at")] = 0.0,
    view: View = False,
    as_json: AsJson = False,
) -> None:
    """Play a recording as if it were live; with --track, track its orders: as `rotor track` does, at any rate."""
    from rotorrig.app.commands import replay

    seconds = replay.play(run, rate=rate, view=view, track=track, begin=begin)
    words = f"{track or run}: {seconds:.1f} s replayed" + (" and tracked" if track else "")
    tell(words, {"file": str(run), "seconds": seconds, "tracked": str(track) if track else None}, as_json=as_json)


def track(
    run: Recording,
    out_file: Out,
    trial: Trial = None,
    turns: Annotated[int, typer.Option(help="of the shaft in a row: more average more noise, and smear more")] = 8,
    orders: Annotated[str, typer.Option(help="multiples of the speed; 0 is the gap")] = "0,0.5,1,2,3",
    method: Annotated[
        Literal["resampling", "least-squares", "vold-kalman"],
        typer.Option(help="windowed DFT over the shaft angle; a fit of all orders at once; a Vold-Kalman filter"),
    ] = "resampling",
    every: Annotated[
        str | None, typer.Option(help="rows at steps of '10 rpm' or '0.5 s'", show_default="one after another")
    ] = None,
    slow_roll: Annotated[
        str | None,
        typer.Option(help="speeds to take the slow roll at, '200 to 400 rpm'", show_default="the run of that name"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Track the orders of a recording into a response file, the slow-roll vector beside them.

    Trial masses are those the sweep noted; --trial stands instead of them.
    """
    from rotorrig.acquisition.files import open_recording
    from rotorrig.app.text import quality_words, spacing_words, tracked_facts, tracked_words
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
    said = [words for words in (spacing_words(response, settings), *quality_words(response)) if words]
    facts = {"file": str(out_file), **tracked_facts(response), "said": said}
    tell(f"{out_file}: {tracked_words(response)}", facts, as_json=as_json)
    for words in [] if as_json else said:
        err.print(words, highlight=False, markup=False, soft_wrap=True)


def import_(
    file: Annotated[Path, typer.Argument(help="CSV, UFF, TDMS, WAV; with --ross a rotor of ROSS", show_default=False)],
    out_file: Out,
    config: Annotated[Path | None, typer.Option("--config", help="the rig's TOML file", show_default=False)] = None,
    mapping: Annotated[
        Path | None,
        typer.Option("--mapping", "--vectors", help="a TOML file that says what channels or columns mean"),
    ] = None,
    ross: Annotated[bool, typer.Option("--ross", help="FILE is a rotor saved by ROSS: make a config of it")] = False,
    keep_nodes: Annotated[bool, typer.Option("--keep-nodes", help="with --ross: every element a section")] = False,
    as_json: AsJson = False,
) -> None:
    """Bring in waveforms (to a run.mcap), by its mapping a Bode table (to a response.mcap), with --ross a rotor."""
    from rotorrig.app.commands import import_files, ross_exchange

    if ross and (config or mapping):
        raise ConfigError("--ross: wants neither --config nor --mapping, it makes a config")
    if ross:
        lines = ross_exchange.bring_in(file, out=out_file, keep_nodes=keep_nodes)
    elif config is None:
        raise ConfigError("--config: is missing, want the rig's TOML file, as it says what the columns are")
    else:
        with working(f"reading {file.name}"):
            lines = [import_files.bring_in(file, rig=load_config(config), mapping=mapping, out=out_file)]
    tell("\n".join(lines), {"file": str(out_file), "said": lines}, as_json=as_json)


def export(
    file: Annotated[Path, typer.Argument(help="a run.mcap or response.mcap; with --ross a config", show_default=False)],
    out_file: Out,
    ross: Annotated[bool, typer.Option("--ross", help="write the rotor of a config, for ROSS")] = False,
    max_element: Annotated[str, typer.Option(help="with --ross: the longest shaft element")] = "20 mm",
    as_json: AsJson = False,
) -> None:
    """Write waveforms of a run or order vectors of a response as .csv or .uff; with --ross, a rotor for ROSS.

    Of a response, a .json is a layout that shows it in Foxglove.
    """
    from rotorrig.app.commands import export_files

    if ross:
        from rotorrig.app.commands import ross_exchange

        lines = ross_exchange.write_out(find_config(file), out=out_file, max_element=max_element)
    else:
        with working(f"writing {out_file.name}"):
            lines = [export_files.write_out(file, out_file)]
    tell("\n".join(lines), {"file": str(out_file), "said": lines}, as_json=as_json)


def salvage(run: Recording, out_file: Out, as_json: AsJson = False) -> None:
    """Make a valid recording of one that was cut off."""
    from dataclasses import asdict

    from rotorrig.acquisition.files import salvage as save

    with working(f"reading {run.name}"):
        saved = save(run, out_file)
    lost = "nothing was lost" if saved.whole else f"{saved.lost_bytes} bytes could not be read"
    words = f"{out_file}: {saved.seconds:.2f} s saved, {lost}"
    tell(words, {"file": str(out_file), **asdict(saved)}, as_json=as_json)
