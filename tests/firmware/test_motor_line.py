"""The C implementation of the line protocol, compiled, against the worked examples of docs/motor-line.md."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "firmware" / "motor_line"
SPEC = ROOT / "docs" / "motor-line.md"
COMPILER = next((found for name in ("cc", "gcc", "clang") if (found := shutil.which(name))), None)

pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler named cc, gcc or clang")


@pytest.fixture(scope="module")
def controller(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compile the example as the strictest of its users would."""
    program = tmp_path_factory.mktemp("motor_line") / "controller"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "-O1"]
    sources = [str(SOURCES / name) for name in ("example.c", "motor_line.c")]
    subprocess.run([str(COMPILER), *flags, "-o", str(program), *sources], check=True)
    return program


def answers(controller: Path, sent: bytes) -> list[str]:
    done = subprocess.run([str(controller)], input=sent, capture_output=True, timeout=10, check=True)
    return done.stdout.decode("ascii").splitlines()


def lines_of_spec() -> list[str]:
    """The lines of the worked example, in order."""
    example = SPEC.read_text(encoding="utf-8").partition("## Worked example")[2].split("```")[1]
    return re.findall(r"^[<>][0-9A-F]{2} [^*\n]*\*[0-9A-F]{4}", example, flags=re.MULTILINE)


def sent(*lines: str) -> bytes:
    return "".join(line + "\n" for line in lines).encode("ascii")


def test_it_answers_the_specs_requests_with_the_specs_bytes(controller: Path) -> None:
    requests = [line for line in lines_of_spec() if line[0] == ">"]
    replies = [line for line in lines_of_spec() if line[0] == "<"]
    answered = answers(controller, sent(*requests))
    assert len(answered) == len(requests) == len(replies) == 10
    for reply, said in zip(replies, answered, strict=True):
        # its motor is where it is told to be at once and never too hot: STATE differs, all else is the spec's
        assert said == reply or reply[1:3] in ("03", "04", "07")
    assert answered[4].startswith("<03 OK 120000 120000 at-speed -*")


def test_a_repetition_is_answered_again_and_not_done_again(controller: Path) -> None:
    # STATE under 03, a stop, and STATE under 03 again: the second is late and dropped, its repetition too
    state, stop = ">03 STATE*D971", ">05 STOP EMERGENCY*682F"
    speed = ">02 SPEED 120000 3000*B1BF"
    begun = answers(controller, sent(">00 ID*B8EA", speed, state, state, stop, state, speed))
    assert [line[:9] for line in begun] == ["<00 OK 1 ", "<02 OK*85", "<03 OK 12", "<03 OK 12", "<05 OK*D4"]
    assert begun[2] == begun[3]


def test_a_late_stop_is_obeyed_and_the_last_reply_kept(controller: Path) -> None:
    late_stop, watchdog = ">05 STOP EMERGENCY*682F", ">06 SPEED 500000 3000*766D"
    answered = answers(controller, sent(">00 ID*B8EA", watchdog, late_stop, watchdog))
    assert answered[2] == "<05 OK*D4A6"
    assert answered[1] == answered[3] == "<06 ERR limit speed 500000, at most 420000*07E3"


def test_before_the_first_id_it_takes_a_stop_and_nothing_else(controller: Path) -> None:
    assert answers(controller, sent(">02 SPEED 120000 3000*B1BF", ">05 STOP EMERGENCY*682F")) == ["<05 OK*D4A6"]


@pytest.mark.parametrize(
    "damaged",
    [
        b">02 SPEED 120000 3000*B1BE\n",  # CRC
        b">02 SPEED 220000 3000*B1BF\n",  # a digit
        b">02 SPEED 120000 3000*b1bf\n",  # lower case
        b">02 SPEED 120000 3000 B1BF\n",
        b"<02 OK*858B\n",  # a reply: its own echo
        b"\n",
        b">\n",
        b">02 " + b"A" * 200 + b"*0000\n",
        bytes(range(256)) + b"\n",
    ],
)
def test_what_is_damaged_is_met_with_silence_and_the_next_line_is_heard(controller: Path, damaged: bytes) -> None:
    heard = answers(controller, b">00 ID*B8EA\n" + damaged + b"noise>05 STOP EMERGENCY*682F\r\n")
    assert [line[:6] for line in heard] == ["<00 OK", "<05 OK"]
