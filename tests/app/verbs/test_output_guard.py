"""No verb loses a file to a slip: every output of every verb of the command is held to the same rules."""

import os
import socket
import stat
import sys
from collections.abc import Iterator
from inspect import signature
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from docs.cli_reference import verbs
from rotorrig.acquisition.files import KINDS, LAB_PARQUET, FileKind, FileWriter, content_kind
from rotorrig.app import cli
from rotorrig.app.verbs.output_guard import check_outputs, outputs_of
from rotorrig.rig import DataError, Provenance
from rotorrig.rig.config import RigConfig
from tests.parameters import defer_rest

RK4 = Path(__file__).parents[3] / "configs/rk4.toml"
#: arguments that name a file to read; any other path of any verb is held to be an output
READ = {
    *("config", "run", "response", "responses", "file", "fit", "diagnosis", "holdout", "hidden", "faults", "mapping"),
    *("after", "balance"),
}
Case = tuple[str, str]  # verb, argument
#: folders that go on with what is there, are made anew by a guard of their own, or are only read: tests/app/lab,
#: tests/app/commands/test_investigate.py
RESUMED = {
    *(("investigate", "folder"), ("lab run", "folder"), ("lab query", "folder")),
    *(("lab page", "folder"), ("lab page", "out_folder")),
}


def commands() -> dict[str, Any]:
    return verbs()


def written() -> Iterator[Case]:
    groups = [(f"{group.name} ", group.typer_instance) for group in cli.app.registered_groups]
    for prefix, app in [("", cli.app), *groups]:
        for command in app.registered_commands if app else ():
            assert command.callback
            hints, verb = get_type_hints(command.callback), f"{prefix}{command.name}"
            for argument in signature(command.callback).parameters:
                is_path = "Path" in str(hints[argument])
                if is_path and argument not in READ and (verb, argument) not in RESUMED:
                    yield verb, argument


CASES = list(written())
every_output = pytest.mark.parametrize(("verb", "argument"), CASES, ids=[f"{v}-{a}" for v, a in CASES])


def test_the_verbs_that_write_are_found() -> None:
    assert {verb for verb, _ in CASES} >= {"init", "sweep", "replay", "track", "identify", "diagnose", "report"}
    assert {verb for verb, _ in CASES} >= {"view", "import", "export", "salvage", "demo", "lab query"}
    assert ("diagnose", "rig_out") in CASES


@pytest.fixture
def samples(tmp_path: Path, rig_config: RigConfig) -> dict[str, Path]:
    """A file of every kind, each under a name that says nothing about it."""
    folder = tmp_path / "samples"
    folder.mkdir()
    texts = {
        "fit": '{"kind": "rotorrig fit"}',
        "diagnosis": '{"kind": "rotorrig diagnosis"}',
        "balance": '{"kind": "rotorrig balance"}',
        "prediction": '{"kind": "rotorrig prediction"}',
        "investigation": '{"kind": "rotorrig investigation"}',
        "proof": '{"kind": "rotorrig proof test"}',
        "report": "<!DOCTYPE html>\n<head>\n<title>RK4: rotor report</title>",
        "rrd": "RRF2 and so on",
        "config": RK4.read_text(),
        "csv": "time [s],1X [V]\n0.0,-9.9\n",
        "uff": "    -1\n    58\n",
        "layout": '{"configById": {}}',
        "ross": 'ross_version = "2.3"\n',
        "truth": '{"schema": "rotorrig.plant.truth/2"}',
        "other": "notes of a day in the laboratory\n",
    }
    for kind, text in texts.items():
        (folder / kind).write_text(text)
    pq.write_table(pa.table({"x": [1.0]}).replace_schema_metadata({LAB_PARQUET: "select 1"}), folder / "parquet")
    source = Provenance(config_hash="", code_version="")
    for kind in ("run", "response"):
        FileWriter(folder / kind, kind=FileKind(name=kind, version=1, remedy=""), rig=rig_config, source=source).close()
    return {kind: folder / kind for kind in (*texts, "parquet", "run", "response")}


def test_a_kind_is_told_by_the_content(samples: dict[str, Path], tmp_path: Path) -> None:
    assert {kind: content_kind(path) for kind, path in samples.items()} == {kind: kind for kind in samples}
    assert set(samples) | {"empty", "mcap"} == set(KINDS)
    (tmp_path / "nothing").touch()
    assert content_kind(tmp_path / "nothing") == "empty"
    (tmp_path / "cut").write_bytes(samples["run"].read_bytes()[:40])
    assert content_kind(tmp_path / "cut") == "mcap"


def option_of(verb: str, argument: str) -> str:
    parameter = next(p for p in commands()[verb].params if p.name == argument)
    return str(parameter.opts[0])


def place_for(verb: str, folder: Path) -> Path:
    """A name that the verb would write to."""
    return folder / {"export": "x.csv", "predict": "x.csv", "view": "x.rrd"}.get(verb, "x.out")


def words_of(verb: str, argument: str, target: Path, folder: Path) -> list[str]:
    """A command line that writes to `target`; whatever it reads is a file of no use, which is looked at later."""
    words = verb.split()
    for parameter in commands()[verb].params:
        if parameter.name == "name":
            words.append("rk4")
        elif parameter.required and not parameter.opts[0].startswith("-"):
            words.append(str(folder / "input"))
        elif parameter.required and parameter.name != argument:
            words += [parameter.opts[0], str(place_for(verb, folder).with_stem("elsewhere"))]
    return [*words, option_of(verb, argument), str(target)]


@pytest.fixture
def refused(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Any:
    """Runs a command line and returns its sentence; it must refuse, and leave every file as it was."""

    def run(verb: str, argument: str, target: Path, *more: str) -> str:
        (tmp_path / "input").touch()
        given = target.parent if verb == "demo" else target  # the file is one of those in its folder
        before = snapshot(tmp_path)
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(cli.err, "_width", 400)
        monkeypatch.setattr(sys, "argv", ["rotor", *words_of(verb, argument, given, tmp_path), *more])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        printed = capsys.readouterr()
        assert ended.value.code == 1
        assert printed.err.startswith("error: ") and printed.err.count("\n") == 1, printed.err
        assert snapshot(tmp_path) == before
        return printed.err

    return run


def snapshot(folder: Path) -> dict[str, object]:
    def look(path: Path) -> object:
        if path.is_symlink():
            return path.readlink()
        return path.read_bytes() if path.is_file() else stat.S_IFMT(path.stat().st_mode)

    return {str(path): look(path) for path in sorted(folder.rglob("*"))}


def in_folder(verb: str, folder: Path) -> Path:
    """The file that is slipped on: for the demo, one it writes into its folder."""
    if verb != "demo":
        return place_for(verb, folder)
    (folder / "demo").mkdir(exist_ok=True)
    return folder / "demo" / "run.mcap"


@every_output
@pytest.mark.parametrize("slip", ["itself", "another spelling", "link", "hard link"])
def test_an_input_is_never_written_to(verb: str, argument: str, slip: str, refused: Any, tmp_path: Path) -> None:
    target, more = in_folder(verb, tmp_path), ["--force"]
    source = RK4 if verb == "init" else tmp_path / "input"  # init's input comes with the program
    (tmp_path / "samples").mkdir()
    if slip == "link":
        target.symlink_to(source)
    elif slip == "hard link" and verb != "init":  # RK4 may be on another file system
        source.touch()
        target.hardlink_to(source)
    elif verb != "demo":
        target = tmp_path / "samples/../input" if slip == "another spelling" and verb != "init" else source
    if verb == "demo":
        more += ["--config", str(source if "link" in slip else target)]
    words = refused(verb, argument, target, *more)
    assert "is the input file" in words or (verb == "export" and "ends in ''" in words)


@pytest.mark.parametrize(("verb", "argument"), defer_rest(CASES, now=5))
def test_a_file_of_another_kind_is_never_replaced(
    verb: str, argument: str, refused: Any, samples: dict[str, Path], tmp_path: Path
) -> None:
    target = in_folder(verb, tmp_path)
    own = own_kind(verb, argument, target)
    for kind, sample in samples.items():
        if kind != own:
            target.write_bytes(sample.read_bytes())
            assert f"is {KINDS[kind]} already" in refused(verb, argument, target, "--force")


@every_output
def test_a_file_of_the_same_kind_is_replaced_with_force_alone(
    verb: str, argument: str, refused: Any, samples: dict[str, Path], tmp_path: Path
) -> None:
    target = in_folder(verb, tmp_path)
    own = own_kind(verb, argument, target)
    target.write_bytes(samples[own].read_bytes())
    assert "or --force to replace it" in refused(verb, argument, target)
    check(verb, argument, target, force=True)
    target.chmod(0o444)
    assert "write-protected" in refused(verb, argument, target, "--force")


@every_output
@pytest.mark.parametrize("thing", ["/dev/null", "pipe", "socket", "folder", "link to nothing"])
def test_only_a_regular_file_is_written(verb: str, argument: str, thing: str, refused: Any, tmp_path: Path) -> None:
    target = in_folder(verb, tmp_path)
    match thing:
        case "/dev/null":
            target.symlink_to("/dev/null")
        case "pipe":
            os.mkfifo(target)
        case "socket":
            place = os.open(tmp_path, os.O_RDONLY)
            with socket.socket(socket.AF_UNIX) as made:
                made.bind(f"/proc/self/fd/{place}/{target.relative_to(tmp_path)}")
            os.close(place)
        case "folder":
            target.mkdir()
        case "link to nothing":
            target.symlink_to(tmp_path / "nowhere")
    words = refused(verb, argument, target, "--force")
    assert "want a regular file" in words or "a link to nothing" in words


@every_output
@pytest.mark.parametrize("folder", [".", ".."])
def test_a_folder_without_a_name_of_its_own_is_no_file(
    verb: str, argument: str, folder: str, refused: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "here"
    place.mkdir()
    monkeypatch.chdir(place)
    if verb == "demo":  # which writes its files into it
        check(verb, argument, Path(folder), force=False)
    else:
        wrong = "ends in ''" if verb == "export" else "is a folder, want a regular file"  # whose suffix says the format
        assert f"{folder}: {wrong}" in refused(verb, argument, Path(folder), "--force")


@every_output
def test_a_place_that_cannot_be_written_is_noticed_before_the_work(
    verb: str, argument: str, refused: Any, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    for folder, why in (
        ("/proc/self", "cannot be written"),
        (tmp_path / "file", "cannot be written (Not a directory)"),
    ):
        assert why in refused(verb, argument, place_for(verb, Path(folder)))
    if verb != "demo":  # which makes its folder
        assert "(No such file or directory)" in refused(verb, argument, place_for(verb, tmp_path / "missing"))


@every_output
def test_a_new_file_is_let_through(verb: str, argument: str, tmp_path: Path) -> None:
    check(verb, argument, in_folder(verb, tmp_path), force=False)


def test_two_outputs_are_two_files(refused: Any, tmp_path: Path) -> None:
    twice = tmp_path / "elsewhere.out"
    assert "is an output already" in refused("diagnose", "rig_out", twice)


def check(verb: str, argument: str, target: Path, *, force: bool) -> None:
    """Ask the guard alone."""
    marks = outputs_of(commands()[verb].callback)
    given = dict.fromkeys((p.name for p in commands()[verb].params), None) | {"force": force}
    check_outputs(marks, given | {argument: target.parent if verb == "demo" else target})


def own_kind(verb: str, argument: str, target: Path) -> str:
    """The kind of file the verb writes there."""
    mark = outputs_of(commands()[verb].callback)[argument]
    if mark.files:
        return mark.files(target.parent)[target]
    given = {"ross": False, "mapping": None, "out_file": target}
    return mark.kind if isinstance(mark.kind, str) else mark.kind(given)


def test_with_ross_another_kind_is_written(samples: dict[str, Path], tmp_path: Path) -> None:
    for verb, own in (("import", "config"), ("export", "ross")):
        target = tmp_path / "x.toml"
        marks = outputs_of(commands()[verb].callback)
        given = {"ross": True, "mapping": None, "out_file": target, "force": True}
        for kind, sample in samples.items():
            target.write_bytes(sample.read_bytes())
            if kind == own:
                check_outputs(marks, given)
            else:
                with pytest.raises(DataError, match="already, want another name"):
                    check_outputs(marks, given)
