"""The documents cannot lie: every `rotor ...` command of these is run, and what they quote must come out.

A shell block is ```sh, a quoted output ```text. What needs hardware or opens a window is only parsed, as are the
commands of all other pages: tests/documents.
"""

import contextlib
import io
import json
import re
import shlex
import shutil
import sys
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import pyuff

from benchmarks.parts.blind.run import record
from docs.make_tutorial import COLUMNS
from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.acquisition.importers.channel_mapping import load_channels
from rotorrig.acquisition.recording import RawRecording
from rotorrig.app import cli
from rotorrig.app.terminal.console import err, out
from rotorrig.identify.result_files import read_identification
from rotorrig.processing.files.bode_table import read_table
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.sims.plant.sealed_truth import unseal
from tests.documents.pages import ROOT, blocks, commands, text_of

DOCUMENTS = ("README.md", "docs/your-data.md", "docs/tutorial.md")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
#: which effects a recording just shows or does not depends on its noise, and no two simulated sweeps have the same
NOISY = re.compile(
    r"Causes tried.*?(?=At their)|At their typical size this data would not show:[^.]*\.|"
    r"Pulled in the config, by group.*σ \([^)]*\)|The fit pulls at nothing the config states by more than 2 sigma\.|"
    r"furthest \w+ at"
)  # on either side of a limit, as the sweep went


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What a command of a document did."""

    command: str
    code: int
    said: str


def runnable(words: list[str]) -> bool:
    needs_nothing = words[1] not in ("sweep", "investigate") or {"--simulate", "--dry-run"} & set(words)
    hardware = {"--view", "--connect"} | ({"--proof-test"} if "--simulate" not in words else set())
    return not hardware & set(words) and bool(needs_nothing)


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
        for name in ("configs", "docs/tutorial", "tests/data/kfupm-rk4"):
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


class Outcomes(dict[str, list[Outcome]]):
    """What every command of a document did, run in order in the document's folder when it is first asked for."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __missing__(self, document: str) -> list[Outcome]:
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(self._folder / Path(document).stem)
            patch.setenv("COLUMNS", str(COLUMNS))
            for console in (out, err):  # which took the width they found when they were first imported
                patch.setattr(console, "_width", COLUMNS)
            self[document] = [run(patch, words) for words in commands(document)]
        return self[document]


@pytest.fixture(scope="module")
def outcomes(folder: Path) -> Outcomes:
    return Outcomes(folder)


def run(patch: pytest.MonkeyPatch, words: list[str]) -> Outcome:
    """Run a command in this process; one that needs more than a machine is asked for its help with all its options."""
    patch.setattr(sys, "argv", words if runnable(words) else [*words, "--help"])
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), pytest.raises(SystemExit) as ended:
        cli.main()
    return Outcome(command=shlex.join(words), code=int(ended.value.code or 0), said=said.getvalue())


@pytest.mark.campaign
@pytest.mark.parametrize("document", DOCUMENTS)
def test_every_command_of_a_document_succeeds(document: str, outcomes: Outcomes) -> None:
    assert len(outcomes[document]) >= 7
    assert [(outcome.command, outcome.said) for outcome in outcomes[document] if outcome.code] == []


@pytest.mark.parametrize("option", ["--viw", "--conect"])
def test_a_misspelt_option_of_a_command_that_is_only_parsed_is_found(
    option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run(monkeypatch, ["rotor", "sweep", "configs/rk4.toml", "--out", "run.mcap", "--view", option]).code != 0


@pytest.mark.campaign
def test_the_output_quoted_is_what_comes_out(outcomes: Outcomes) -> None:
    printed = " ".join(" ".join(outcome.said for outcome in outcomes["docs/your-data.md"]).split())
    quoted = [line for text in blocks("docs/your-data.md", "text") for line in text.splitlines()]
    assert len(quoted) > 4
    assert [line for line in quoted if line.strip(" ─") and not comes_out(line, printed)] == []


def comes_out(line: str, printed: str) -> bool:
    """Return whether the words of `line` are in what was printed, with whatever numbers."""
    return re.search(NUMBER.pattern.join(map(re.escape, NUMBER.split(" ".join(line.split())))), printed) is not None


@pytest.mark.campaign
def test_the_report_of_the_measured_run_up_begins_as_quoted(folder: Path, outcomes: Outcomes) -> None:
    words = "The model does NOT describe this run"
    assert outcomes["docs/your-data.md"]
    assert f'"{words}"' in (ROOT / "docs/your-data.md").read_text()
    assert words in (folder / "your-data/measured.html").read_text().partition("<section")[2][:500]


def test_the_mapping_shown_reads_a_table(tmp_path: Path, rig_config: RigConfig) -> None:
    (mapping,) = (text for text in blocks("docs/your-data.md", "toml") if "[[vectors]]" in text)
    (tmp_path / "mapping.toml").write_text(mapping)
    rows = [f"{1000 + 10 * k},{10 + k + 7 * k * k % 5 / 10},{30 + 3 * k * k % 4 / 10}" for k in range(9)]  # with noise
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


@pytest.mark.campaign
def test_a_recording_and_its_csv_give_the_same_values(folder: Path, outcomes: Outcomes) -> None:
    assert outcomes["README.md"] and outcomes["docs/your-data.md"]
    (itself,) = read_identification(folder / "README/fit.json").fits
    (csv,) = read_identification(folder / "your-data/fit.json").fits
    assert [e.name for e in itself.estimates] == [e.name for e in csv.estimates]
    for ours, theirs in zip(itself.estimates, csv.estimates, strict=True):
        assert abs(ours.value - theirs.value) < 0.5 * ours.sigma, ours.name
        assert theirs.sigma == pytest.approx(ours.sigma, rel=0.1), ours.name


@pytest.mark.campaign
def test_the_tutorial_shows_what_each_of_its_commands_prints(outcomes: Outcomes) -> None:
    quoted = blocks("docs/tutorial.md", "text")
    assert len(quoted) == len(outcomes["docs/tutorial.md"]) > 7
    for text, outcome in zip(quoted, outcomes["docs/tutorial.md"], strict=True):
        assert words_of(text) - words_of(outcome.said) == Counter(), outcome.command


def words_of(text: str) -> Counter[str]:
    """Return the words of an output, whatever its numbers, its tables' widths and wherever its lines are broken."""
    return Counter(NUMBER.sub("0", re.sub("─+", "─", NOISY.sub("", " ".join(text.split())))).split())


@pytest.mark.campaign
def test_the_tutorial_finds_what_was_hidden_and_needs_it(folder: Path, outcomes: Outcomes) -> None:
    assert outcomes["docs/tutorial.md"]
    quoted = blocks("docs/tutorial.md", "text")
    hidden = json.loads((folder / "tutorial/docs/tutorial/hidden.json").read_text())["faults"]
    found, again = (json.loads((folder / "tutorial" / f"{n}.json").read_text()) for n in ("diagnosis", "again"))
    assert [cause["name"] for cause in found["causes"] if cause["chosen"]] == [fault["name"] for fault in hidden]
    assert found["verdict"] == "named"
    assert not any(cause["chosen"] for cause in again["causes"])
    assert (
        again["base"]["chi2"] < 1.1 * again["base"]["dof"]
    )  # the rig's pedestal slides and rocks: in some sweeps it shows
    assert any(f"{found['causes'][0]['label']} " in text and "in the model" in text for text in quoted)
    gain = found["gain"]  # differs from sweep to sweep: the page's was 4.6 times, another 3.1
    assert gain["heldout_after"] < min(gain["heldout_before"] / 3, 2 * gain["noise_floor"])


def test_what_the_tutorial_hides_can_be_swept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = blocks("docs/tutorial.md", "python")
    shutil.copytree(ROOT / "docs/tutorial", tmp_path / "docs/tutorial")
    monkeypatch.chdir(tmp_path)
    exec(program)
    assert unseal(tmp_path / "hidden.json").faults[0].name == "coupling"


@pytest.mark.campaign
def test_every_key_of_fit_json_is_documented(folder: Path, outcomes: Outcomes) -> None:
    assert outcomes["docs/tutorial.md"]
    table = json.loads((folder / "tutorial/fit.json").read_text())
    documented = text_of("docs/results.md").partition("## diagnosis.json")[0]
    fit = table["fits"][0]
    keys = [*table, *fit, *(key for key in fit["estimates"][0] if key != "name")]
    assert [key for key in keys if not re.search(rf"`\.?{key}(\[\]|{{}})?`", documented)] == []
