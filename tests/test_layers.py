"""The import table of the architecture, enforced: who may import whom, and where third parties may appear."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "rotorrig"

BASE = tuple(
    f"rig.{name}"
    for name in [
        "description",
        "nameplate",
        "devices",
        "sweep_plans",
        "extension",
        "trial_mass",
        "checking",
        "provenance",
        "errors",
        "clock",
        "units",
        "toml_file",
        "unit_registry",
    ]
)

#: package -> (own modules it may import, third-party packages it may import); the longest prefix counts
TABLE: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    **{base: (BASE, ("pydantic", "pint")) for base in BASE},
    "rig": (("rig",), ("serial", "pymodbus", "can", "canopen", "opendaq", "nidaqmx")),
    "acquisition": (("rig", "acquisition"), ("mcap", "google", "pyuff", "nptdms")),
    "processing": (
        (
            "processing",
            "acquisition.recording",
            "acquisition.mcap_file",
            "acquisition.schemas",
            "acquisition.foxglove_schemas",
            "acquisition.exporters",
            "rig.probes",
            *BASE,
        ),
        ("scipy", "numba"),
    ),
    "sims.rotor": (("sims.rotor", *BASE), ("scipy", "numba")),
    "sims.effects": (("sims.effects", "sims.rotor", *BASE), ("scipy", "numba")),
    "sims.matched": (("sims.effects", "sims.rotor", *BASE), ("scipy", "numba")),
    "sims.plant": (("sims.plant", *BASE), ("scipy", "numba")),
    "sims.wire": (
        ("sims.wire", "sims.plant.plant", "sims.plant.truth", *BASE),
        ("serial", "pymodbus", "can", "canopen"),
    ),
    "sims.wire.faults": (BASE, ("pydantic",)),
    "identify": (
        ("identify", "processing.response", "processing.probe_planes", "sims.rotor", "sims.effects", *BASE),
        ("scipy", "threadpoolctl"),
    ),
    "identify.chea": (("identify.chea",), ("scipy",)),
    "app": (
        ("rig", "acquisition", "processing", "sims", "identify", "app"),
        ("scipy", "pydantic", "rerun", "typer", "rich", "plotly", "threadpoolctl"),
    ),
}
EVERYWHERE = {*sys.stdlib_module_names, "numpy"}
MODULES = sorted(ROOT.rglob("*.py"))


def name_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def within(module: str, prefixes: tuple[str, ...]) -> bool:
    return any(module == p or module.startswith(p + ".") for p in prefixes)


def row_for(module: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    matches = [key for key in TABLE if within(module, (key,))]
    assert matches, f"{module} stands in no row of the import table"
    return TABLE[max(matches, key=len)]


def imports_of(tree: ast.AST) -> list[str]:
    found: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative import: write the whole name"
            found += [f"{node.module}.{a.name}" for a in node.names] if node.module else []
    return found


def faults(module: str, tree: ast.AST) -> list[str]:
    own, foreign = row_for(module)
    wrong = []
    for imported in imports_of(tree):
        top = imported.split(".")[0]
        if top == "rotorrig":
            inner = imported.removeprefix("rotorrig").lstrip(".")
            if inner and not within(inner, own):
                wrong.append(imported)
        elif top not in EVERYWHERE and top not in foreign:
            wrong.append(imported)
    return wrong


@pytest.mark.parametrize("path", [m for m in MODULES if m.name != "__init__.py"], ids=name_of)
def test_module_imports_only_what_its_layer_may(path: Path) -> None:
    assert faults(name_of(path), ast.parse(path.read_text())) == []


def test_init_files_import_nothing() -> None:
    for path in MODULES:
        if path.name == "__init__.py":
            assert imports_of(ast.parse(path.read_text())) == [], f"{path} re-exports something"


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("sims.plant.shaft", "from rotorrig.sims.rotor.beam import anything"),
        ("sims.plant.plant", "import rotorrig.identify.polish"),
        ("sims.wire.modbus_motor", "from rotorrig.rig.motor.modbus_frames import encode"),
        ("sims.wire.probe_daq", "from rotorrig.rig.probes import daq_frames"),
        ("identify.chea.genetic", "from rotorrig.rig.errors import RigError"),
        ("identify.adequacy", "import rerun"),
        ("acquisition.engine", "from rotorrig.processing.tacho import pulses"),
        ("rig.motor.modbus_motor", "from rotorrig.app.cli import main"),
        ("rig.description", "import scipy"),
    ],
)
def test_a_forbidden_import_is_found(module: str, line: str) -> None:
    assert faults(module, ast.parse(line))
