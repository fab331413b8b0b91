import numpy as np
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from rotorrig.acquisition.files.block_message import WAVEFORM, pack_block, unpack_blocks
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.probes.base import Block
from rotorrig.sims.plant.draw import draw
from rotorrig.sims.plant.plant import Plant


def block(counts: np.ndarray) -> Block:
    return Block(counts=counts, first_sample=7, t_ns=11, overrun=True)


@given(
    counts=hnp.arrays(np.int32, st.tuples(st.integers(0, 30), st.integers(1, 9))),
)
def test_any_counts_come_back_as_they_were(counts: np.ndarray) -> None:
    (read,) = unpack_blocks([WAVEFORM.cls(**pack_block(block(counts)))])
    assert read.counts.dtype == np.int32
    assert np.array_equal(read.counts, counts)
    assert (read.first_sample, read.t_ns, read.overrun) == (7, 11, True)


def test_bytes_are_the_counts_channel_after_channel_little_endian() -> None:
    fields = pack_block(block(np.array([[1, -1], [2, 258]], dtype=np.int32)))
    assert (fields["dtype"], fields["coding"]) == ("int16", "")
    assert fields["counts"] == bytes.fromhex("0100 0200 ffff 0201")
    assert np.array_equal(np.frombuffer(fields["counts"], "<i2").reshape(2, 2), [[1, 2], [-1, 258]])


def coded(counts: bytes, *, samples: int, channels: int) -> np.ndarray:
    """Return the counts of a message with coding "delta"."""
    fields = {"dtype": "int16", "coding": "delta", "samples": samples, "channels": channels, "counts": counts}
    return unpack_blocks([WAVEFORM.cls(**fields)])[0].counts


def test_planes_of_folded_differences_are_read() -> None:
    # channel 0: 1, 2, -256: differences 1, 1, -258, folded (0, -1, 1, -2, ... = 0, 1, 2, 3, ...) 2, 2, 515 = 0x203
    # channel 1: -1, 258, 258: differences -1, 259, 0, folded 1, 518 = 0x206, 0
    counts = coded(bytes.fromhex("020203 010600 000002 000200"), samples=3, channels=2)
    assert np.array_equal(counts, [[1, -1], [2, 258], [-256, 258]])


def test_a_difference_beyond_the_range_wraps_and_comes_back() -> None:
    # 65535 is -1 modulo 2^16, folded 1; -32768 folds to 65535, then 1, then +1 to 2
    assert coded(bytes.fromhex("ff0102 ff0000"), samples=3, channels=1).ravel().tolist() == [-32768, 32767, -32768]


def test_blocks_that_follow_each_other_lie_side_by_side() -> None:
    counts = np.arange(60, dtype=np.int32).reshape(20, 3)
    parts = [Block(counts=counts[i : i + 5] + shift, first_sample=i + shift, t_ns=i) for i, shift in SIDE_BY_SIDE]
    messages = [WAVEFORM.cls(**pack_block(part)) for part in parts]
    blocks = unpack_blocks(messages)
    assert messages == []
    assert [np.array_equal(a.counts, b.counts) for a, b in zip(blocks, parts, strict=True)] == [True] * 4
    assert blocks[0].counts.base is blocks[1].counts.base
    assert blocks[2].counts.base is blocks[3].counts.base is not blocks[0].counts.base


SIDE_BY_SIDE = ((0, 0), (5, 0), (10, 7), (15, 7))  # first sample, samples missing before it


def test_a_simulated_run_up_takes_less_than_08_of_its_int16(rig_config: RigConfig) -> None:
    plant = Plant(rig_config, draw(rig_config, seed=7))
    plant.command(400.0, 100.0, True)
    counts = plant.advance(5.0)  # through the critical speeds
    chunks = [counts[i : i + 1000] for i in range(0, len(counts) - 999, 1000)]  # a tenth of a second each
    packed_bytes = sum(len(zstandard.compress(pack_block(block(chunk))["counts"])) for chunk in chunks)
    assert packed_bytes < 0.8 * 2 * counts[: 1000 * len(chunks)].size


@pytest.mark.parametrize(("value", "dtype"), [(32767, "int16"), (-32768, "int16"), (32768, "int32"), (-32769, "int32")])
def test_sixteen_bits_are_used_only_where_they_suffice(value: int, dtype: str) -> None:
    assert pack_block(block(np.array([[value]], dtype=np.int32)))["dtype"] == dtype


@pytest.mark.parametrize(
    "wrong",
    [
        {"dtype": "float64"},
        {"coding": "wavelet"},
        {"samples": 10**15},
        {"channels": -5, "samples": -2},
        {"counts": b"\0"},
        {"channels": 0},
    ],
)
def test_fields_that_contradict_one_another_are_refused(wrong: dict[str, object]) -> None:
    message = WAVEFORM.cls(**(pack_block(block(np.zeros((2, 5), dtype=np.int32))) | wrong))
    with pytest.raises(ValueError, match=r"dtype|coding|counts for"):
        unpack_blocks([message])
