"""What a hostile file, name or neighbour on the network gets out of the program: nothing."""

import ast
import dataclasses
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from mcap.records import Message
from mcap.writer import CompressionType, Writer

from rotorrig.acquisition.files import mcap_records
from rotorrig.app.commands.other_programs.import_files import bring_in
from rotorrig.app.report.page import write_report
from rotorrig.app.viewer.result.view import write_result_rrd
from rotorrig.identify.identification import Estimate, Fit, Identification
from rotorrig.identify.result_files import read_diagnosis, read_identification, write_diagnosis, write_identification
from rotorrig.processing.files.response_mcap import read_response, write_response
from rotorrig.processing.response import Run
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import LONGEST, DataError, RigError
from rotorrig.rig.provenance import Provenance
from tests.app.conftest import make_cause, make_diagnosis, make_response, prediction_of
from tests.app.test_cli import run

ROOT = Path(__file__).parents[1] / "rotorrig"
MODULES = sorted(ROOT.rglob("*.py"))

#: modules that can run what a file holds -> where they may be imported, and why
RUNS_DATA = {
    #: functions and jobs on their way to this program's own child processes
    "pickle": {"identify/chea/calls/workers.py", "app/lab/kernels.py"},
    "marshal": set(),
    "shelve": set(),
    "dill": set(),
    "cloudpickle": set(),
    "joblib": set(),
    "yaml": set(),
    "runpy": set(),
}
CALLS = {"eval", "exec", "compile", "__import__", "os.system", "os.popen", "tempfile.mktemp"}
EVERY_ADDRESS = {"0.0.0.0", "::", "[::]"}


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def faults(name: str, tree: ast.AST) -> list[str]:
    """Return what in a module could run a file's contents, or listen to the whole network."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
            found += [f"imports {m}" for m in modules if m in RUNS_DATA and name not in RUNS_DATA[m]]
        elif isinstance(node, ast.Call):
            called = ast.unparse(node.func)
            found += [f"calls {called}"] if called in CALLS else []
            for keyword in node.keywords:
                is_off = isinstance(keyword.value, ast.Constant) and keyword.value.value is False
                if keyword.arg in ("shell", "allow_pickle") and not is_off:
                    found.append(f"{called}({ast.unparse(keyword)})")
        elif isinstance(node, ast.Constant) and node.value in EVERY_ADDRESS:
            found.append(f"has the address {node.value}, of every interface")
    return found


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_no_module_runs_data_or_listens_to_the_network(path: Path) -> None:
    assert faults(name_of(path), ast.parse(path.read_text())) == []


@pytest.mark.parametrize(
    "line",
    [
        "import pickle",
        "from yaml import load",
        "eval(text)",
        "subprocess.run(command, shell=True)",
        "np.load(path, allow_pickle=allowed)",
        "server.bind(('0.0.0.0', 502))",
    ],
)
def test_a_dangerous_line_is_found(line: str) -> None:
    assert faults("app/report/page.py", ast.parse(line))


HOSTILE = (
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "</script><svg onload=alert(1)>",
    "<!--<script>",
    "<a href='javascript:alert(1)'>x</a>",
    "${script} $title %s {0}",
    "</title></style><iframe src=//evil.example>",
)


class Elements(HTMLParser):
    """Tags and attributes of a page, in order."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: set[str] = set()
        self.links: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes |= {name for name, _ in attrs}
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "action", "data")]


def renamed(rig: RigConfig, word: str) -> RigConfig:
    """Return the rig with `word` wherever a name is free text."""
    parts = {
        kind: tuple(part.model_copy(update={"name": f"{part.name} {word}"}) for part in getattr(rig, kind))
        for kind in ("disks", "bearings")
    }
    return rig.model_copy(update={"name": f"rig {word}", "notes": f"notes {word}", "identify": None, **parts})


def write_page(folder: Path, rig: RigConfig, word: str) -> str:
    """Return the report of a run in which every quoted text is `word`, by way of the files it is made of."""
    source = Provenance(config_hash=word, code_version=word, source=word, source_hash=word)
    made = make_response(renamed(rig, word), rows=40)
    response = dataclasses.replace(
        made,
        runs=(
            Run(name=f"slow roll {word}", direction=0),
            Run(name=f"up {word}", direction=1),
            Run(name=word, direction=-1),
        ),
        reasons=((f"1x: {word}",),) * len(made.omega),
        source=source,
    )
    write_response(folder / "response.mcap", response)
    prediction = prediction_of(response)
    estimates = tuple(
        Estimate(name=n, value=1.0, sigma=0.1, unit=u, nameplate=1.0)
        for n, u in (("kxx", "N/m"), (f"u {word}", "kg m"), (word, word))
    )
    fit = Fit(
        name=word,
        band=(50.0, 400.0),
        estimates=estimates,
        nuisances=estimates,
        unknowns=("kxx",),
        optima=(),
        objective=word,
        evaluations=1,
        stop=word,
        seed=0,
        chi2=10.0,
        dof=5,
        prediction=prediction,
        words=(word,),
    )
    write_identification(folder / "fit.json", Identification(fits=(fit,), effects=(word,), wall_s=1.0, source=source))
    cause = make_cause("bow", word, chosen=True, evidence=30.0, after=1e-6)
    cause = dataclasses.replace(cause, label=f"bow, {word}", where=word, words=f"{word} is bent")
    diagnosis = make_diagnosis(response, prediction, adequate=False)
    worst = dataclasses.replace(diagnosis.worst[0], run=word, probe=word, sentence=word)
    diagnosis = dataclasses.replace(diagnosis, sentence=word, worst=(worst,), causes=(cause,), source=source)
    write_diagnosis(folder / "diagnosis.json", diagnosis)
    write_report(
        folder / "report.html",
        response=read_response(folder / "response.mcap"),
        identification=read_identification(folder / "fit.json"),
        diagnosis=read_diagnosis(folder / "diagnosis.json"),
    )
    return (folder / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def harmless(rig_config: RigConfig, tmp_path_factory: pytest.TempPathFactory) -> Elements:
    return Elements(write_page(tmp_path_factory.mktemp("harmless"), rig_config, "word"))


@pytest.mark.parametrize("word", [" ".join(HOSTILE), HOSTILE[3]], ids=["all", "comment"])
def test_a_report_quotes_and_does_not_obey(
    word: str, harmless: Elements, rig_config: RigConfig, tmp_path: Path
) -> None:
    page = write_page(tmp_path, rig_config, word)
    found = Elements(page)
    assert found.tags == harmless.tags
    assert found.attributes == harmless.attributes
    assert found.links == harmless.links
    assert not any(name.startswith("on") for name in found.attributes)
    for data in re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', page, re.DOTALL):
        json.loads(data)
        assert "<" not in data


@pytest.mark.parametrize("word", ["[/red]", r"\[/red]", "[bold]", "[link=evil]x"])
def test_names_are_no_markup_of_the_terminal(
    word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path(f"{word}.csv").parent.mkdir(parents=True, exist_ok=True)  # a slash parts folders
    table = "time [s],keyphasor [V],1x [V],1y [V],2x [V],2y [V]\n" + "".join(f"{k},-2,-9,-9,-9,-9\n" for k in range(9))
    Path(f"{word}.csv").write_text(table.replace("[s]", "[ms]"))
    config = ROOT.parent / "configs/rk4.toml"
    assert run(monkeypatch, capsys, "import", f"{word}.csv", "--config", config, "--out", f"{word}.mcap")[1] == (
        f"{word}.mcap: 0.0 s, 9 scans at 1000 Hz\n"
    )
    assert run(monkeypatch, capsys, "export", f"{word}.mcap", "--out", f"{word}.uff")[1] == (
        f"{word}.uff: 5 time responses in volts\n"
    )
    code, _, err = run(monkeypatch, capsys, "export", f"no{word}.mcap", "--out", f"{word}.uff", "--force")
    assert (code, err) == (1, f"error: no{word}.mcap: is not there, want a run.mcap or a response.mcap\n")


@pytest.mark.parametrize("word", [" ".join(HOSTILE), "/../../x\n\0"], ids=["markup", "path"])
def test_a_picture_for_the_viewer_takes_any_name(word: str, rig_config: RigConfig, tmp_path: Path) -> None:
    made = make_response(renamed(rig_config, word), rows=5)
    runs = tuple(dataclasses.replace(run, name=f"{run.name} {word}") for run in made.runs)
    write_result_rrd(tmp_path / "result.rrd", dataclasses.replace(made, runs=runs))
    assert [path.name for path in tmp_path.iterdir()] == ["result.rrd"]


def test_what_a_terminal_would_obey_is_not_printed() -> None:
    error = RigError("x.csv: got '\x1b]0;owned\x07\x1b[2J', a\nb\tc\u202e")
    assert str(error) == "x.csv: got ' ]0;owned  [2J', a b c "
    assert len(str(RigError("x" * 10**6))) < LONGEST + 10


def test_an_import_writes_its_target_and_nothing_else(rig_config: RigConfig, tmp_path: Path) -> None:
    table = "time [s],keyphasor [V],1x [V],1y [V],2x [V],2y [V],../../escape [V]\n"
    rows = "".join(f"{k / 1e3},-2,-9,-9,-9,-9,0\n" for k in range(20))
    source, out = tmp_path / "in" / "waves.csv", tmp_path / "out" / "run.mcap"
    source.parent.mkdir()
    out.parent.mkdir()
    source.write_text(table + rows)
    bring_in(source, rig=rig_config, mapping=None, out=out)
    assert sorted(p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*") if p.is_file()) == [
        "in/waves.csv",
        "out/run.mcap",
    ]
    out.unlink()
    source.write_text(table + rows.replace("-9", "nan"))
    with pytest.raises(DataError):
        bring_in(source, rig=rig_config, mapping=None, out=out)
    assert list(out.parent.iterdir()) == []


def test_an_import_never_replaces_its_source(rig_config: RigConfig, tmp_path: Path) -> None:
    path = tmp_path / "waves.csv"
    table = "time [s],keyphasor [V],1x [V],1y [V],2x [V],2y [V]\n"
    path.write_text(table + "".join(f"{i * 1e-4:.4f},0,-9,-9,-9,-9\n" for i in range(20)))
    with pytest.raises(DataError, match=r"waves\.csv: is there already, want a name that is free"):
        bring_in(path, rig=rig_config, mapping=None, out=path)
    assert path.read_text().startswith(table)


def test_a_small_file_does_not_unpack_to_more_memory_than_it_may(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mcap_records, "SPARE_LIMIT", 2**20)
    path = tmp_path / "run.mcap"
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=2**20, compression=CompressionType.ZSTD)
        writer.start()
        channel = writer.register_channel("/waveform", "protobuf", writer.register_schema("x", "protobuf", b""))
        for t_ns in range(64):
            writer.add_message(channel, t_ns, bytes(2**20), t_ns)
        writer.finish()
    size = path.stat().st_size
    unpacked, faults = 0, []
    for record in mcap_records.read_records(path):
        if isinstance(record, mcap_records.Fault):
            faults.append(record.what)
        elif isinstance(record, Message):
            unpacked += len(record.data)
    assert size < 30_000
    assert unpacked < 2**20 + 1000 * size + 2**21
    assert faults == [f"more than {(2**20 + 1000 * size) / 2**30:.2g} GiB unpacked"]
