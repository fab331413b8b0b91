"""Scripts as a user writes them: what is understood, and the sentence for what is not."""

import json
import math
from pathlib import Path

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.sims.wire.fault_script import (
    Corrupt,
    Disconnect,
    DriveFault,
    Script,
    StuckSpeed,
    parse_script,
    read_script,
)

RPM = math.pi / 30


def test_a_script_is_a_list_of_faults_in_units_of_choice() -> None:
    script = parse_script(
        """[{"kind": "corrupt", "on": "motor", "at": "1 min", "count": 1},
            {"kind": "disconnect", "on": "daq", "above": "900 rpm", "lasts": 2},
            {"kind": "drive-fault", "code": 7}]""",
        where="script",
    )
    assert script == Script(
        faults=(
            Corrupt.model_construct(kind="corrupt", on="motor", at=60.0, count=1),
            Disconnect.model_construct(kind="disconnect", on="daq", above=pytest.approx(900 * RPM), lasts=2.0),
            DriveFault.model_construct(kind="drive-fault", on="motor", code=7),
        )
    )


def test_a_seed_may_stand_beside_the_faults() -> None:
    script = parse_script('{"seed": 7, "faults": [{"kind": "stuck-speed"}]}', where="script")
    assert script.seed == 7
    assert isinstance(script.faults[0], StuckSpeed)


@pytest.mark.parametrize(
    ("script", "sentence"),
    [
        ('[{"kind": "dorp", "on": "motor"}]', "faults[0].kind: got 'dorp', did you mean 'drop'"),
        ('[{"on": "motor"}]', "faults[0].kind: is missing, want one of drop, corrupt, "),
        ('[{"kind": "drop"}]', "faults[0].on: is missing"),
        ('[{"kind": "drop", "on": "drive"}]', "faults[0].on: got 'drive', input should be 'motor' or 'daq'"),
        ('[{"kind": "drop", "on": "daq", "share": 0}]', "faults[0].share: got 0, input should be greater than 0"),
        ('[{"kind": "drop", "on": "daq", "for": 1}]', "faults[0].for: unknown key, want one of at, above, lasts, "),
        ('[{"kind": "delay", "on": "daq"}]', "faults[0].by: is missing"),
        ('[{"kind": "silent", "on": "daq", "at": "3 mm"}]', "faults[0].at: got '3 mm'"),
        ('[{"kind": "silent", "on": "daq", "at": -1}]', "faults[0].at: got -1, input should be greater than or equal"),
        ('[{"kind": "silent", "on": "daq", "at": NaN}]', "faults[0].at: got nan"),
        ('[{"kind": "stuck-speed", "on": "daq"}]', "faults[0].on: got 'daq', input should be 'motor'"),
        ('[{"kind": "wrong-device", "on": "daq", "address": 3}]', "faults[0]: address: a DAQ has none"),
        ("[3]", "faults[0]: "),
        ("3", "got 3, want a list of faults"),
        ("[", "is no valid JSON: "),
        (100_000 * "[", "is no valid JSON: "),
        ('{"faults": [], "sede": 1}', "sede: unknown key, did you mean 'seed'"),
    ],
)
def test_what_is_no_script_is_said_in_one_sentence(script: str, sentence: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_script(script, where="script.json")
    assert str(caught.value).startswith(f"script.json: {sentence}")
    assert "\n" not in str(caught.value)


def test_a_script_file_is_named_in_its_errors(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.json: cannot be read"):
        read_script(tmp_path / "none.json")
    (tmp_path / "latin.json").write_bytes(b'["\xe9"]')
    with pytest.raises(ConfigError, match=r"latin\.json: cannot be read \(not UTF-8 text\)"):
        read_script(tmp_path / "latin.json")


def test_the_scripts_of_the_documentation_are_scripts() -> None:
    text = (Path(__file__).parents[3] / "docs" / "simulated-rig.md").read_text()
    block = text.split("```json\n")[1].split("```")[0]
    assert len(parse_script(block, where="docs").faults) == len(json.loads(block)) == 3
