"""Signals while a rotor turns: counted, acted on at once, and broken out by only where the loop hangs."""

import os
import signal
import threading

import pytest

from rotorrig.acquisition.sweep.interrupts import HANDLED, Interrupts


def test_the_rotor_is_stopped_from_the_handler_itself_the_first_two_times() -> None:
    stops: list[int] = []
    with Interrupts(stop=lambda: stops.append(1), loop_hangs=lambda: False) as interrupts:
        for count in (1, 2, 3, 4):
            signal.raise_signal(signal.SIGTERM if count == 1 else signal.SIGINT)
            assert interrupts.count == count
    assert len(stops) == 2
    assert interrupts.first == "SIGTERM"


def test_a_loop_that_hangs_is_broken_out_of_by_the_third() -> None:
    with Interrupts(stop=lambda: None, loop_hangs=lambda: True):
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


def test_ctrl_z_does_nothing_meanwhile_and_all_is_as_before_afterwards() -> None:
    numbers = (*HANDLED, signal.SIGTSTP)
    before = [signal.getsignal(number) for number in numbers]
    with Interrupts(stop=lambda: None, loop_hangs=lambda: False):
        os.kill(os.getpid(), signal.SIGTSTP)  # would stop the test run
        assert signal.getsignal(signal.SIGTSTP) is signal.SIG_IGN
    assert [signal.getsignal(number) for number in numbers] == before


def test_outside_the_main_thread_signals_are_left_alone() -> None:
    seen: list[object] = []

    def run() -> None:
        with Interrupts(stop=lambda: None, loop_hangs=lambda: False):
            seen.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert seen == [before]
