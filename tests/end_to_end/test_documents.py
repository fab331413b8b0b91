"""The documents cannot lie: every `rotor ...` command they show is run, and what they quote must come out.

A shell block is ```sh, a quoted output ```text. What needs hardware or opens a window is only parsed.
"""

import contextlib
import io
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import pyuff

from benchmarks.blind_run import record
from rotorrig.acquisition.importers.channel_mapping import load_channels
from rotorrig.acquisition.mcap_file import write_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.app import cli
from rotorrig.identify.result_files import read_identification
from rotorrig.processing.vector_table import read_table
from rotorrig.rig.description import RigConfig, parse

ROOT = Path(__file__).parents[2]
DOCUMENTS = ("README.md", "docs/your-data.md")
BLOCK = re.compile(r"^```(sh|text|toml)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
LINK = re.compile(r"\]\(([^)#:]+)\)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What a command of a document did."""

    command: str
    code: int
    said: str


def blocks(document: str, kind: str) -> list[str]:
    return [text for found, text in BLOCK.findall((ROOT / document).read_text()) if found == kind]


def commands(document: str) -> list[list[str]]:
    """Return the words of each `rotor` command in the shell blocks of a document."""
    lines = "".join(blocks(document, "sh")).replace("\\\n", " ").splitlines()
    return [words for line in lines if (words := shlex.split(line, comments=True))[:1] == ["rotor"]]


def runnable(words: list[str]) -> bool:
    needs_nothing = words[1] != "sweep" or {"--simulate", "--dry-run"} & set(words)
    return not {"--view", "--connect"} & set(words) and bool(needs_nothing)


@pytest.fixture(scope="module")
def lab_rig(hurried_rig: RigConfig) -> RigConfig:
    """The hurried RK4 at 4 kHz, without the second fit over a band: enough for a command to run."""
    text = hurried_rig.text
    for old, new in (('"10 kHz"', '"4 kHz"'), ("bands = ", "# bands = ")):
        assert old in text
        text = text.replace(old, new)
    return parse(text, where="my.toml")


@pytest.fixture(scope="module")
def recording(lab_rig: RigConfig) -> RawRecording:
    """A blind plant's sweep; without marks, as a CSV has none, so that the runs are found from the speed in both."""
    return replace(record(lab_rig, seed=7), events=())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, recording: RawRecording) -> Path:
    """A folder per document with the files its commands begin with."""
    folder = tmp_path_factory.mktemp("documents")
    for document in DOCUMENTS:
        place = folder / Path(document).stem
        place.mkdir()
        for name in ("configs", "tests/data/kfupm-rk4"):
            shutil.copytree(ROOT / name, place / name)
    write_recording(folder / "README/run.mcap", recording)
    (folder / "your-data/my.toml").write_text(recording.rig.text)
    write_waveforms(folder / "your-data/waves.csv", recording)
    write_universal_file(folder / "your-data/recorder.uff", recording)
    (folder / "your-data/channels.toml").write_text(channels_of(recording))
    return folder


def write_waveforms(path: Path, recording: RawRecording) -> None:
    """Write a CSV as another program would: times to 10 us, volts to 10 mV, displacement to 0.1 um."""
    rig = recording.rig
    (_, counts), *gaps = recording.segments()
    assert not gaps
    volts = counts * np.array(recording.daq.volts_per_count)
    assert rig.keyphasor is not None
    columns = [np.arange(len(volts)) / recording.daq.sample_rate, volts[:, rig.keyphasor.channel]]
    columns += [(volts[:, p.channel] - p.gap_voltage) / p.sensitivity * 1e6 for p in rig.probes]
    heading = ",".join(["time [s]", "keyphasor [V]", *(f"{p.name} [um]" for p in rig.probes)])
    digits = ["%.5f", "%.2f", *["%.1f"] * len(rig.probes)]
    np.savetxt(path, np.column_stack(columns), fmt=digits, delimiter=",", header=heading, comments="")


def write_universal_file(path: Path, recording: RawRecording) -> None:
    """Write data sets 58 by pyuff: a recorder's channels AI0, AI1, ... in volts."""
    (_, counts), *gaps = recording.segments()
    assert not gaps
    times = np.arange(len(counts)) / recording.daq.sample_rate
    file = pyuff.UFF(str(path))
    for channel, volts in enumerate((counts * np.array(recording.daq.volts_per_count)).T):
        signal = pyuff.prepare_58(
            func_type=1, rsp_node=1, rsp_dir=0, ref_node=0, ref_dir=0, data=volts, x=times, binary=0,
            id1=f"AI{channel}", abscissa_spacing=1, abscissa_spec_data_type=17, ordinate_spec_data_type=1,
            orddenom_spec_data_type=0, z_axis_spec_data_type=0, ordinate_axis_units_lab="V",
        )  # fmt: skip
        file.write_sets(signal, mode="add")


def channels_of(recording: RawRecording) -> str:
    """Return the mapping of such a file: which channel is whose."""
    rig = recording.rig
    assert rig.keyphasor is not None
    owners = [("keyphasor", rig.keyphasor.channel), *((probe.name, probe.channel) for probe in rig.probes)]
    return "\n".join(f'[[channels]]\nprobe = "{name}"\nchannel = "AI{at}"\nunit = "1 V"' for name, at in owners)


@pytest.fixture(scope="module")
def outcomes(folder: Path) -> Iterator[dict[str, list[Outcome]]]:
    """What every command of every document did, run in order in the document's folder."""
    with pytest.MonkeyPatch.context() as patch:
        found: dict[str, list[Outcome]] = {}
        for document in DOCUMENTS:
            patch.chdir(folder / Path(document).stem)
            found[document] = [run(patch, words) for words in commands(document)]
        yield found


def run(patch: pytest.MonkeyPatch, words: list[str]) -> Outcome:
    """Run a command in this process; one that needs more than a machine is asked for its help with all its options."""
    patch.setattr(sys, "argv", words if runnable(words) else [*words, "--help"])
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), pytest.raises(SystemExit) as ended:
        cli.main()
    return Outcome(command=shlex.join(words), code=int(ended.value.code or 0), said=said.getvalue())


@pytest.mark.parametrize("document", DOCUMENTS)
def test_every_command_of_a_document_succeeds(document: str, outcomes: dict[str, list[Outcome]]) -> None:
    assert len(outcomes[document]) >= 7
    assert [(outcome.command, outcome.said) for outcome in outcomes[document] if outcome.code] == []


@pytest.mark.parametrize("option", ["--viw", "--conect"])
def test_a_misspelt_option_of_a_command_that_is_only_parsed_is_found(
    option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run(monkeypatch, ["rotor", "sweep", "configs/rk4.toml", "--out", "run.mcap", "--view", option]).code != 0


def test_the_output_quoted_is_what_comes_out(outcomes: dict[str, list[Outcome]]) -> None:
    printed = " ".join(" ".join(outcome.said for outcome in outcomes["docs/your-data.md"]).split())
    quoted = [line for text in blocks("docs/your-data.md", "text") for line in text.splitlines()]
    assert len(quoted) > 4
    assert [line for line in quoted if line.strip(" ─") and not comes_out(line, printed)] == []


def comes_out(line: str, printed: str) -> bool:
    """Return whether the words of `line` are in what was printed, with whatever numbers."""
    return re.search(NUMBER.pattern.join(map(re.escape, NUMBER.split(" ".join(line.split())))), printed) is not None


def test_the_report_of_the_measured_run_up_begins_as_quoted(folder: Path, outcomes: dict[str, list[Outcome]]) -> None:
    words = "The model does NOT describe this run"
    assert outcomes
    assert f'"{words}"' in (ROOT / "docs/your-data.md").read_text()
    assert words in (folder / "your-data/measured.html").read_text().partition("<section")[2][:500]


def test_the_mapping_shown_reads_a_table(tmp_path: Path, rig_config: RigConfig) -> None:
    (mapping,) = (text for text in blocks("docs/your-data.md", "toml") if "[[vectors]]" in text)
    (tmp_path / "mapping.toml").write_text(mapping)
    rows = [f"{1000 + 10 * k},{10 + k},30" for k in range(9)]
    (tmp_path / "table.csv").write_text("\n".join(["rpm,amp,phase", *rows]))
    response = read_table(tmp_path / "table.csv", tmp_path / "mapping.toml", rig_config)
    assert response.z[0, 0, 0] == pytest.approx(10e-6 * np.exp(-1j * np.pi / 6))
    assert response.alpha[0] == pytest.approx(np.pi)  # 30 rpm/s


def test_the_channels_shown_are_a_mapping(tmp_path: Path, rig_config: RigConfig) -> None:
    (mapping,) = (text for text in blocks("docs/your-data.md", "toml") if "[[channels]]" in text)
    (tmp_path / "channels.toml").write_text(mapping)
    found = load_channels(tmp_path / "channels.toml", rig_config)
    assert found.rate == 25_600.0
    assert [(c.probe, c.channel, c.unit, c.override) for c in found.channels] == [("1x", "AI0", "1 V", True)]


def test_a_recording_and_its_csv_give_the_same_values(folder: Path, outcomes: dict[str, list[Outcome]]) -> None:
    assert outcomes
    (itself,) = read_identification(folder / "README/fit.json").fits
    (csv,) = read_identification(folder / "your-data/fit.json").fits
    assert [e.name for e in itself.estimates] == [e.name for e in csv.estimates]
    for ours, theirs in zip(itself.estimates, csv.estimates, strict=True):
        assert abs(ours.value - theirs.value) < 0.5 * ours.sigma, ours.name
        assert theirs.sigma == pytest.approx(ours.sigma, rel=0.1), ours.name


@pytest.mark.parametrize("document", ["README.md", *(f"docs/{path.name}" for path in sorted(ROOT.glob("docs/*.md")))])
def test_what_a_document_links_to_is_there(document: str) -> None:
    place = (ROOT / document).parent
    assert [link for link in LINK.findall((ROOT / document).read_text()) if not (place / link).exists()] == []
