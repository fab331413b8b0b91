"""Parts of a peer bench for its tests."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.peers.inverter import Inverter
from tests.peers.journal import Journal


class Time:
    """A clock that is told the time."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def time() -> Time:
    return Time()


@pytest.fixture
def journal(tmp_path: Path) -> Iterator[Journal]:
    made = Journal(tmp_path / "journal.jsonl")
    yield made
    made.close()


@pytest.fixture
def inverter(journal: Journal, time: Time) -> Inverter:
    made = Inverter(journal, clock=time)
    made.up = made.down = 100.0
    return made
