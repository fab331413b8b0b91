"""The command that cuts the drive's power: run, and what came of it said in a sentence."""

import threading
import time
from pathlib import Path

import pytest

from rotorrig.rig.config.devices import PowerCut
from rotorrig.rig.control import cut_power


def table(*command: str, timeout: float = 5.0) -> PowerCut:
    return PowerCut.model_validate({"command": command, "timeout": timeout}, context={"si": True})


def test_the_command_is_run_with_its_arguments_and_no_shell(tmp_path: Path) -> None:
    off = tmp_path / "off; $HOME"
    assert cut_power(table("touch", str(off))) == "power cut: 'touch' was run"
    assert off.exists()


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("echo first >&2; echo relay 3: no answer >&2; exit 7", "power cut: 'sh' ended with 7 (relay 3: no answer)"),
        ("exit 1", "power cut: 'sh' ended with 1"),
        ("kill -9 $$", "power cut: 'sh' ended with -9"),
        (r"printf '\377' >&2; exit 1", "power cut: 'sh' ended with 1 (\N{REPLACEMENT CHARACTER})"),
    ],
)
def test_a_command_that_fails_is_said_to_in_its_own_last_words(script: str, words: str) -> None:
    assert cut_power(table("sh", "-c", script)) == words


def test_a_program_that_is_missing_or_cannot_be_run_is_named(tmp_path: Path) -> None:
    missing = str(tmp_path / "relay")
    assert cut_power(table(missing)) == f"power cut: '{missing}' cannot be run (No such file or directory)"
    assert cut_power(table("sh", "a\0b")) == "power cut: 'sh' cannot be run (embedded null byte)"


def test_a_command_that_hangs_is_given_up() -> None:
    began = time.monotonic()
    assert cut_power(table("sleep", "30", timeout=0.2)) == "power cut: 'sleep' did not end within 0.2 s"
    assert time.monotonic() - began < 2.0


def test_two_that_cut_the_power_at_once_do_it_one_after_the_other(tmp_path: Path) -> None:
    """A relay's program may hold its port while it runs."""
    script = f"mkdir {tmp_path}/held && sleep 0.2 && rmdir {tmp_path}/held"
    said: list[str] = []
    threads = [threading.Thread(target=lambda: said.append(cut_power(table("sh", "-c", script)))) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert said == ["power cut: 'sh' was run"] * 2
