"""The import table of the architecture, enforced: stages, floors within a folder, faces, third parties, no circles."""

import ast
import graphlib
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "rotorrig"

BASE = ("rig.config", "rig.errors", "rig.provenance", "rig.clock", "rig.whole_file")

#: part -> (own modules it may import, third-party packages it may import); the longest prefix counts
TABLE: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    **dict.fromkeys(BASE, (BASE, ("pydantic", "pint"))),
    "rig": (("rig",), ("serial", "pymodbus", "can", "canopen", "opendaq", "nidaqmx")),
    "acquisition": (("rig", "acquisition"), ("mcap", "google", "pyuff", "nptdms")),
    "processing": (
        ("processing", "acquisition.recording", "acquisition.files", "acquisition.exporters", "rig.probes", *BASE),
        ("scipy", "numba"),
    ),
    "sims.rotor": (("sims.rotor", *BASE), ("scipy", "numba")),
    "sims.effects": (("sims.effects", "sims.rotor", *BASE), ("scipy", "numba")),
    "sims.plant": (("sims.plant", *BASE), ("scipy", "numba")),
    "sims.wire": (
        ("sims.wire", "sims.plant.plant", "sims.plant.truth", "sims.plant.draw", "sims.plant.sealed_truth", *BASE),
        ("serial", "pymodbus", "can", "canopen"),
    ),
    "sims.wire.fault_script": (BASE, ("pydantic",)),
    "identify": (
        (
            "identify",
            "processing.response",
            "processing.probe_planes",
            "processing.resonance",
            "sims.rotor",
            "sims.effects",
            *BASE,
        ),
        ("scipy", "threadpoolctl"),
    ),
    "identify.chea": (("identify.chea",), ("scipy",)),
    "balancing": (
        ("balancing", "identify", "processing.response", *BASE),
        ("scipy", "threadpoolctl"),
    ),
    "investigation": (("investigation", "identify", *BASE), ()),
    "app": (
        ("rig", "acquisition", "processing", "sims", "identify", "balancing", "investigation", "app"),
        (
            *("scipy", "pydantic", "rerun", "typer", "rich", "plotly", "threadpoolctl"),
            *("pandas", "xarray", "pyarrow", "duckdb", "dask", "distributed", "numba"),
        ),
    ),
    "app.lab.page": (
        ("app.lab.page", "app.lab.storage", "app.plot_data", "app.report", "app.text", "processing", *BASE),
        ("plotly",),
    ),
}
EVERYWHERE = {*sys.stdlib_module_names, "numpy", "lazy_loader"}

#: folder -> its floors, lowest first: what stands on one may import from those below it alone
FLOORS: dict[str, tuple[str, ...]] = {
    "rig": (
        "clock errors provenance",
        "serial_port whole_file",
        "config",
        "motor probes ross",
        "connect interlock",
        "control",
    ),
    "rig.probes": (
        "base",
        "calibration clock_comparison lost_daq requirements",
        "keyphasor_speed tally",
        "nidaqmx opendaq stream",
    ),
    "acquisition": ("recording", "files importers sweep", "exporters proof_test replay"),
    "acquisition.proof_test": (
        "certificate last_motion",
        "turns",
        "devices plan stage",
        "protection",
        "protections trial",
        "proof",
    ),
    "processing": (
        "probe_planes resonance response waveform windows",
        "settings shaft_angle",
        "rows",
        "tracking",
        "noise slow_roll",
        "files pipeline",
    ),
    "sims": ("plant rotor", "effects wire"),
    "sims.rotor": ("model", "modes steady", "swept", "nonlinear"),
    "sims.plant": (
        "force_laws motor streams truth",
        "places",
        "deviations",
        "sensors shaft",
        "faults integrate",
        "draw plant sealed_truth",
    ),
    "sims.wire": (
        "background console fault_script plant_port",
        "cables drive simulated_time",
        "launch probe_daq",
        "inputs",
        "fault_player",
        "motors",
        "emulation",
        "bench",
    ),
    "balancing": (
        "row_curves",
        "conditions discrete grade min_max",
        "influence",
        "correction fitted_model",
        "combination determinacy prediction",
        "balance",
        "balance_file balance_reader",
    ),
    "investigation": ("beliefs budget menu", "journal", "choice"),
    "identify": (
        "chea identification measurement",
        "least_squares",
        "base_model",
        "extended_model",
        "adequacy uncertainty",
        "base_fit",
        "causes",
        "verdict",
        "discovery",
        "diagnosis",
        "result_files",
    ),
    "identify.base_fit": ("base_fit", "amplitudes_alone trial_angles", "fit"),
    "identify.chea": (
        "calls session",
        "steps",
        "engine",
        "chapter modern residuals",
        "profiles",
        "search",
        "minimize",
    ),
    "app": ("plot_data text", "report terminal", "viewer", "commands", "lab", "python verbs", "cli"),
    "app.lab.page": ("catalogue numbers", "bode_data trends", "curve_files runs", "pages"),
    "app.lab": (
        "kernels peaks schema settings",
        "storage",
        "cluster recordings",
        "catalogue output page",
        "steps",
        "rows",
        "task",
        "run",
    ),
    "app.viewer": ("blueprint plots sinks", "live result", "open"),
    "app.viewer.live": ("data pipe", "parts view", "process"),
}

LARGEST_FOLDER = 14  # entries: more is a folder that nobody reads through ...
CATALOGUES = {"sims.effects", "sims.plant.faults"}  # ... except where every file is one of a kind, found by its name


@cache
def modules() -> dict[str, ast.Module]:
    """Return every module of rotorrig by its dotted name without "rotorrig."; a folder's is the folder's name."""
    return {name_of(path): ast.parse(path.read_text()) for path in sorted(ROOT.rglob("*.py")) if path.parent != ROOT}


def name_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def folders() -> frozenset[str]:
    return frozenset(name_of(path) for path in ROOT.rglob("__init__.py"))


@cache
def face(folder: str) -> dict[str, str]:
    """Return what a folder exports: name -> the room it comes from."""
    path = ROOT.joinpath(*folder.split("."))
    stub = path / "__init__.pyi"
    tree = ast.parse((stub if stub.exists() else path / "__init__.py").read_text())
    return {
        alias.name: f"{folder}.{node.module}" if node.level else str(node.module).removeprefix("rotorrig.")
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module and (node.level or node.module.startswith("rotorrig."))
        for alias in node.names
    }


def within(module: str, prefixes: Iterable[str]) -> bool:
    return any(module == p or module.startswith(p + ".") for p in prefixes)


def imported(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield (module, name) of every import; the name is empty for `import module`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative import: write the whole name"
            yield from ((str(node.module), alias.name) for alias in node.names)


def rooms_imported(tree: ast.AST) -> Iterator[str]:
    """Yield the rooms of rotorrig that are imported, a name taken from a face counted as its room."""
    for module, name in imported(tree):
        if module.split(".")[0] != "rotorrig":
            continue
        inner = module.removeprefix("rotorrig").lstrip(".")
        whole = f"{inner}.{name}".strip(".")
        if whole in modules():
            yield whole
        elif inner in folders() and name in face(inner):
            yield face(inner)[name]
        elif inner:
            yield inner


def against_the_table(module: str, tree: ast.AST) -> list[str]:
    rows = [key for key in TABLE if within(module, (key,))]
    if not rows and module in folders():
        return []  # a folder of folders
    if not rows:
        return [f"{module} stands in no row of the import table"]
    own, foreign = TABLE[max(rows, key=len)]
    wrong = [f"{module} imports {room}" for room in rooms_imported(tree) if not within(room, own)]
    tops = {name.split(".")[0] for name, _ in imported(tree)} - EVERYWHERE - {"rotorrig", *foreign}
    return wrong + [f"{module} imports {top}" for top in sorted(tops)]


def up_the_stairs(module: str, tree: ast.AST) -> list[str]:
    """Name imports within a folder from the same floor or one above."""
    wrong = []
    for folder, floors in FLOORS.items():
        if not module.startswith(folder + "."):
            continue
        height = {entry: i for i, floor in enumerate(floors) for entry in floor.split()}
        own = module.removeprefix(folder + ".").split(".")[0]
        if own not in height:
            wrong.append(f"{folder}.{own} stands on no floor")
            continue
        for room in rooms_imported(tree):
            other = room.removeprefix(folder + ".").split(".")[0]
            if room.startswith(folder + ".") and other != own and height.get(other, 99) >= height[own]:
                wrong.append(f"{module} imports {room}, which is not below it")
    return wrong


def past_the_face(module: str, tree: ast.AST) -> list[str]:
    """Name imports from a room of another folder, where the folder is what is asked."""
    wrong = []
    for path, name in imported(tree):
        room = path.removeprefix("rotorrig.")
        if path.startswith("rotorrig.") and room in modules() and room not in folders():
            folder = room.rpartition(".")[0]
            if folder and folder not in ("app.verbs", "app.commands", "app") and not within(module, (folder,)):
                wrong.append(f"{module} takes {name} from {room}, want it from {folder}")
    return wrong


def offenders(check) -> list[str]:  # type: ignore[no-untyped-def]
    found = [line for module, tree in modules().items() for line in check(module, tree)]
    return sorted(set(found))


def test_every_module_imports_only_what_its_layer_may() -> None:
    assert offenders(against_the_table) == []


def test_subfolders_import_one_way() -> None:
    assert offenders(up_the_stairs) == []


def test_callers_import_from_the_folder() -> None:
    assert offenders(past_the_face) == []


def test_no_modules_import_each_other_in_a_circle() -> None:
    rooms = {m: tree for m, tree in modules().items() if m not in folders()}
    graph = {m: {room for room in rooms_imported(tree) if room in rooms and room != m} for m, tree in rooms.items()}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as circle:
        pytest.fail(" -> ".join(circle.args[1]))


def test_every_folder_says_what_it_is_for() -> None:
    silent = [f for f in sorted(folders()) if f and len(ast.get_docstring(modules()[f]) or "") < 40]
    assert silent == []


def test_no_folder_has_more_entries_than_one_reads_through() -> None:
    crowded = {}
    for folder in folders() - CATALOGUES:
        path = ROOT.joinpath(*folder.split(".")) if folder else ROOT
        entries = [p for p in path.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()]
        if len(entries) - 1 > LARGEST_FOLDER:
            crowded[folder] = len(entries) - 1
    assert crowded == {}


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("sims.plant.shaft", "from rotorrig.sims.rotor.model import anything"),
        ("sims.plant.plant", "import rotorrig.identify.base_fit.fit"),
        ("sims.wire.motors.modbus_motor", "from rotorrig.rig.motor.modbus_frames import encode"),
        ("sims.wire.probe_daq", "from rotorrig.rig.probes.stream import frames"),
        ("identify.chea.chapter.genetic", "from rotorrig.rig import RigError"),
        ("identify.adequacy.misfit", "import rerun"),
        ("acquisition.sweep.engine", "from rotorrig.processing import track"),
        ("rig.motor.modbus_motor", "from rotorrig.app.cli import main"),
        ("rig.config.description", "import scipy"),
        ("rig.config.description", "from rotorrig.rig import Interlock"),
    ],
)
def test_a_forbidden_import_is_found(module: str, line: str) -> None:
    assert against_the_table(module, ast.parse(line))


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("processing.rows.runs", "from rotorrig.processing.tracking import METHODS"),
        ("identify.base_model.problem", "from rotorrig.identify.causes import select"),
        ("identify.causes.score_test", "from rotorrig.identify import diagnose"),
    ],
)
def test_an_import_up_the_stairs_is_found(module: str, line: str) -> None:
    assert up_the_stairs(module, ast.parse(line))


def test_an_import_past_the_face_is_found() -> None:
    assert past_the_face("app.report.sections.rig", ast.parse("from rotorrig.rig.config.units import RPM"))
