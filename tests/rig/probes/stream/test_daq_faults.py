"""A stream whose frames are lost, damaged, doubled and swapped at random: blocks are true, losses are counted."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.probes.base import DaqCounters
from rotorrig.rig.probes.stream.daq import StreamDaq
from tests.rig.wire_fakes import Board, data_frame

FRAMES, SCANS = 80, 20
KINDS = ("sound", "lost", "damaged", "doubled", "swapped", "after noise")


def truth(frame: int) -> np.ndarray:
    """Return the counts of a frame; they tell the sample they belong to."""
    return (np.arange(SCANS * frame, SCANS * (frame + 1), dtype=np.int32)[:, None] * 7 + np.arange(5)).astype(np.int32)


def spoilt(rng: np.random.Generator) -> Iterator[tuple[bytes, int | None]]:
    """Yield bytes in the order they arrive, each with its frame's number, None where no sound frame is in them."""
    kinds = rng.choice(KINDS, FRAMES, p=(0.5, 0.1, 0.1, 0.1, 0.1, 0.1))
    kinds[-2:] = "sound"  # the end is known to have come
    k = 0
    while k < FRAMES:
        data = data_frame(truth(k), sequence=k, first_scan=SCANS * k)
        match kinds[k]:
            case "sound":
                yield data, k
            case "damaged":
                where = int(rng.integers(len(data)))
                yield data[:where] + bytes([data[where] ^ int(rng.integers(1, 256))]) + data[where + 1 :], None
            case "doubled":
                yield data, k
                yield data, k
            case "swapped":
                yield data_frame(truth(k + 1), sequence=k + 1, first_scan=SCANS * (k + 1)), k + 1
                yield data, k
                k += 1
            case "after noise":
                yield rng.bytes(int(rng.integers(1, 40))).replace(b"\xa5", b"x"), None
                yield data, k
        k += 1


def expected(arrivals: list[int]) -> tuple[list[int], DaqCounters]:
    """Return the frames that make blocks, and what is to be counted of the others."""
    made: list[int] = []
    late = repeated = gaps = 0
    for n, k in enumerate(arrivals):
        if k > (made[-1] if made else -1):
            gaps += k - (made[-1] if made else -1) > 1
            made.append(k)
        elif k in arrivals[:n]:
            repeated += 1
        else:
            late += 1
    lost = FRAMES - len(made)
    return made, DaqCounters(
        blocks=len(made),
        samples=SCANS * len(made),
        gaps=gaps,
        lost_samples=SCANS * lost,
        lost_frames=lost,
        repeated_frames=repeated,
        late_frames=late,
        saturated=(0,) * 5,
    )


@pytest.mark.parametrize("seed", range(12))
def test_every_block_is_true_and_every_loss_is_counted(board: Board, seed: int) -> None:
    arrivals = list(spoilt(np.random.default_rng(seed)))
    made, counted = expected([k for _, k in arrivals if k is not None])
    board.frames = iter([data for data, _ in arrivals])
    with StreamDaq(board.port, sample_rate=10_000.0, channels=5) as daq:
        daq.open()
        daq.start()
        blocks = [daq.read(timeout=2) for _ in made]
        found = daq.counters
    assert [b.first_sample for b in blocks] == [SCANS * k for k in made]
    for block, k in zip(blocks, made, strict=True):
        np.testing.assert_array_equal(block.counts, truth(k))
    assert replace(found, damaged_frames=0, stray_bytes=0) == counted
    noise = sum(len(data) for data, k in arrivals if k is None)
    assert found.stray_bytes == noise
