"""A stop waits for the turn under way and for no other."""

import threading

from rotorrig.rig.motor.turns import Turns
from tests.rig.wire_fakes import wait_for


def test_a_stop_goes_before_those_that_wait_longer() -> None:
    turns, order, threads = Turns(), [], []

    def take(name: str, first: bool) -> None:
        with turns.take(first=first):
            order.append(name)

    with turns.take():
        for name, first in (("read 1", False), ("read 2", False), ("stop", True)):
            thread = threading.Thread(target=take, args=(name, first))
            thread.start()
            threads.append(thread)
            wait_for(lambda: len(turns._queue) == len(threads))
        assert order == []
    for thread in threads:
        thread.join(2.0)
    assert order == ["stop", "read 1", "read 2"]


def test_who_asks_again_at_once_comes_after_who_waits() -> None:
    turns, order = Turns(), []

    def greedy() -> None:
        while order.count("patient") < 20:
            with turns.take():
                order.append("greedy")

    thread = threading.Thread(target=greedy)
    thread.start()
    for _ in range(20):
        with turns.take():
            order.append("patient")
    thread.join(5.0)
    first = order.index("patient")
    assert len(order) - first <= 2 * 20 + 20  # about one of the other's for each of ours, not hundreds


def test_nobody_shares_a_turn() -> None:
    turns, inside, most = Turns(), [], []

    def work(first: bool) -> None:
        for _ in range(200):
            with turns.take(first=first):
                inside.append(1)
                most.append(len(inside))
                inside.pop()

    threads = [threading.Thread(target=work, args=(first,)) for first in (False, False, True)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(10.0)
    assert len(most) == 600
    assert max(most) == 1


def test_a_turn_ends_when_its_block_fails() -> None:
    turns = Turns()
    try:
        with turns.take():
            raise ValueError
    except ValueError:
        pass
    with turns.take(first=True):
        pass
