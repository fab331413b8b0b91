"""The console's own part; what a bench says and answers is in test_bench and test_launch."""

import os
from collections.abc import Iterator
from typing import IO

import pytest

from rotorrig.rig.errors import RigError
from rotorrig.sims.wire.console import Console


@pytest.fixture
def pipes() -> Iterator[tuple[IO[bytes], IO[bytes], IO[bytes], IO[bytes]]]:
    """Both ends of a bench's standard input, read and write, and of its standard output."""
    (hear, ask), (listen, say) = os.pipe(), os.pipe()
    ends = (os.fdopen(hear, "rb"), os.fdopen(ask, "wb", 0), os.fdopen(listen, "rb"), os.fdopen(say, "wb", 0))
    yield ends
    for end in reversed(ends):  # what the console's thread reads last: it ends with its other end
        end.close()


def test_what_is_not_said_in_time_is_an_error_and_so_is_an_early_end(
    pipes: tuple[IO[bytes], IO[bytes], IO[bytes], IO[bytes]],
) -> None:
    _, ask, listen, say = pipes
    console = Console(stdin=ask, stdout=listen)
    say.write(b'{"event": "turns"}\n')
    assert console.wait_for(lambda line: line.get("event") == "turns", timeout=5) == {"event": "turns"}
    with pytest.raises(RigError, match=r"did not say what it was expected to: 0\.05 s have passed"):
        console.wait_for(lambda line: line.get("event") == "rests", timeout=0.05)
    say.close()
    with pytest.raises(RigError, match="did not say what it was expected to: it ended"):
        console.wait_for(lambda line: line.get("event") == "rests", timeout=5)
    assert console.messages == ({"event": "turns"},)


def test_a_bench_that_is_gone_is_said(pipes: tuple[IO[bytes], IO[bytes], IO[bytes], IO[bytes]]) -> None:
    hear, ask, listen, _ = pipes
    hear.close()
    with pytest.raises(RigError, match="the simulated bench is gone"):
        Console(stdin=ask, stdout=listen).speed()
