"""`import rotorrig as rr`: quick, lazy, and the same verbs as the command's."""

import json
import subprocess
import sys

import rotorrig as rr
from rotorrig.identify import Diagnosis, identify

HEAVY = ("numpy", "scipy", "pandas", "xarray", "plotly", "pydantic", "rerun", "numba")


def run(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True).stdout


def test_the_import_loads_nothing_heavy() -> None:
    loaded = json.loads(run(f"import json, sys, rotorrig; print(json.dumps([n for n in {HEAVY} if n in sys.modules]))"))
    assert loaded == []


def test_every_name_of_the_face_is_there() -> None:
    assert [name for name in rr.__all__ if getattr(rr, name) is None] == []
    assert {"read", "track", "identify", "diagnose", "simulate", "report", "Rotor"} <= set(dir(rr))


def test_identify_is_a_verb_and_a_folder_whichever_is_asked_for_first() -> None:
    asked = "try:\n    rr.identify([])\nexcept rr.DataError as error:\n    print(error)\n"
    folder = "from rotorrig.identify import Diagnosis\nimport rotorrig.identify.chea\n"
    for code in (f"import rotorrig as rr\n{asked}{folder}{asked}", f"import rotorrig as rr\n{folder}{asked}{asked}"):
        assert run(code).splitlines() == ["no response was given, want at least one"] * 2


def test_the_folder_of_identify_is_still_one() -> None:
    assert sys.modules["rotorrig.identify"].Diagnosis is Diagnosis
    assert sys.modules["rotorrig.identify"].identify is identify
