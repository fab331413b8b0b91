"""The operator at a real terminal: heard without waiting, never at the price of a program that stops."""

import os
import sys
import termios
from collections.abc import Iterator
from io import TextIOWrapper

import pytest

from rotorrig.acquisition.sweep.plans import Ask, Ramp
from rotorrig.app.terminal import operator as terminal
from rotorrig.app.terminal.operator import Terminal, operator_for
from rotorrig.rig.errors import ConfigError

PLAN = (Ramp(to=60.0, rate=10.0), Ask(request="mount 'disk: 1 g mm at 0 deg'"))


@pytest.fixture
def keys(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Make standard input a terminal in the foreground; what is written to the number returned is typed there."""
    master, slave = os.openpty()
    stdin = TextIOWrapper(os.fdopen(slave, "rb"))
    monkeypatch.setattr(sys, "stdin", stdin)
    monkeypatch.setattr(os, "tcgetpgrp", lambda number: os.getpgrp())  # a test run owns no terminal
    yield master
    os.close(master)
    stdin.close()


def typed(master: int, text: bytes) -> None:
    os.write(master, text)
    termios.tcdrain(master)


def test_s_and_enter_end_the_sweep(keys: int) -> None:
    operator = Terminal(say=print)
    assert not operator.wants_stop()
    typed(keys, b"s")
    assert not operator.wants_stop()  # not before Enter
    typed(keys, b"\n")
    assert operator.wants_stop()


def test_other_keys_end_nothing(keys: int) -> None:
    operator = Terminal(say=print)
    typed(keys, b"speed\n\n")
    assert not operator.wants_stop()


def test_a_request_is_answered_with_enter_pressed_since(keys: int) -> None:
    said: list[str] = []
    operator = Terminal(say=said.append)
    typed(keys, b"\n")
    assert not operator.wants_stop()
    operator.ask("mount it")
    assert said == ["The rotor is at rest: mount it, then press Enter."]
    assert not operator.has_answered()
    typed(keys, b"\n")
    assert operator.has_answered()


def test_a_rehearsal_waits_for_nobody(keys: int) -> None:
    operator = operator_for(PLAN, say=print, yes=True)
    operator.ask("mount it")
    assert operator.has_answered()


def test_without_a_terminal_nobody_can_be_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    with open(os.devnull) as nothing:  # noqa: PTH123
        monkeypatch.setattr(sys, "stdin", nothing)
        with pytest.raises(ConfigError, match="asks for trial masses to be mounted and there is no terminal"):
            operator_for(PLAN, say=print, yes=False)
        assert operator_for(PLAN[:1], say=print, yes=False).wants_stop() is False


def test_a_program_in_the_background_leaves_the_keys_to_the_one_in_front(
    keys: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "tcgetpgrp", lambda number: os.getpgrp() + 1)
    typed(keys, b"s\n")
    assert terminal.read_typed_lines() == []


def test_a_terminal_that_is_gone_is_no_error(keys: int) -> None:
    os.close(os.dup(keys))
    sys.stdin.close()
    assert terminal.read_typed_lines() == []
