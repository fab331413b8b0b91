"""What arrives of a message; the answers follow from the faults' definitions."""

import asyncio
import json
import time
from typing import Any

import numpy as np
import pytest

from rotorrig.sims.wire.background import run_jobs
from rotorrig.sims.wire.cables.interference import Interference, Lane
from rotorrig.sims.wire.fault_script import parse_script

MESSAGE = bytes(range(16))


def interference(*faults: dict[str, Any], seed: int = 1) -> Interference:
    acting = Interference()
    for fault in parse_script(json.dumps([{"on": "motor", **fault} for fault in faults]), where="test").faults:
        acting.begin(fault, np.random.default_rng(seed))  # type: ignore[arg-type]
    return acting


def arrived(acting: Interference, *, toward: Any = "to-device") -> list[bytes]:
    return acting.disturb(MESSAGE, toward)[0]


def test_without_faults_a_message_arrives_at_once_as_it_is() -> None:
    assert interference().disturb(MESSAGE, "to-device") == ([MESSAGE], 0.0)


def test_a_dropped_message_does_not_arrive_and_a_shortened_one_keeps_its_order() -> None:
    assert arrived(interference({"kind": "drop"})) == []
    (short,) = arrived(interference({"kind": "drop", "bytes": 3}))
    assert len(short) == 13
    assert sorted(short) == list(short)
    assert arrived(interference({"kind": "drop", "bytes": 16})) == []


def test_as_many_bits_flip_as_asked_for() -> None:
    for bits in (1, 5):
        (damaged,) = arrived(interference({"kind": "corrupt", "bits": bits}))
        assert len(damaged) == len(MESSAGE)
        assert sum((a ^ b).bit_count() for a, b in zip(damaged, MESSAGE, strict=True)) == bits


def test_a_duplicate_arrives_twice_and_faults_add_up() -> None:
    assert arrived(interference({"kind": "duplicate"})) == [MESSAGE, MESSAGE]
    acting = interference({"kind": "duplicate"}, {"kind": "delay", "by": 0.25}, {"kind": "delay", "by": 0.5})
    assert acting.disturb(MESSAGE, "to-device") == ([MESSAGE, MESSAGE], 0.75)


def test_a_fault_of_one_direction_leaves_the_other_alone() -> None:
    acting = interference({"kind": "drop", "direction": "from-device"})
    assert arrived(acting, toward="to-device") == [MESSAGE]
    assert arrived(acting, toward="from-device") == []


def test_a_fault_of_so_many_messages_is_spent_after_them() -> None:
    acting = interference({"kind": "drop", "count": 2})
    assert [len(arrived(acting)) for _ in range(4)] == [0, 0, 1, 1]


def test_a_share_of_the_messages_is_hit_and_the_seed_draws_which() -> None:
    hits = [[arrived(acting) == [] for _ in range(2000)] for acting in (_thirty_percent(seed) for seed in (1, 1, 2))]
    assert hits[0] == hits[1] != hits[2]
    assert sum(hits[0]) == pytest.approx(600, abs=5 * (2000 * 0.3 * 0.7) ** 0.5)


def _thirty_percent(seed: int) -> Interference:
    return interference({"kind": "drop", "share": 0.3}, seed=seed)


def test_nothing_gets_through_a_silent_link() -> None:
    acting = interference()
    acting.silence(True)
    assert arrived(acting) == []
    acting.silence(False)
    assert arrived(acting) == [MESSAGE]


def test_late_messages_keep_their_order_and_do_not_hold_up_their_sender() -> None:
    acting = interference({"kind": "delay", "by": 0.2, "count": 3})
    arrivals: list[tuple[bytes, float]] = []

    async def job() -> float:
        began = time.monotonic()

        async def arrive(message: bytes) -> None:
            arrivals.append((message, time.monotonic() - began))

        lane = Lane(acting, "to-device", arrive)
        async with run_jobs(lane.run()):
            for word in (b"1", b"2", b"3"):
                await lane.put(word)
            sent = time.monotonic() - began
            await lane.put(b"4")  # in time itself, but behind the late ones
        return sent

    sent = asyncio.run(job())
    assert [word for word, _ in arrivals] == [b"1", b"2", b"3", b"4"]
    assert sent < 0.2 <= arrivals[0][1] <= arrivals[3][1] < 0.6  # not 0.2 s each


def test_a_message_in_time_is_delivered_before_its_sender_goes_on() -> None:
    arrived: list[bytes] = []

    async def arrive(message: bytes) -> None:
        await asyncio.sleep(0.01)
        arrived.append(message)

    asyncio.run(Lane(interference(), "to-device", arrive).put(b"x"))
    assert arrived == [b"x"]
