import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from rotorrig.acquisition.block_message import WAVEFORM, packed, unpacked
from rotorrig.rig.probes.base import Block


def block(counts: np.ndarray) -> Block:
    return Block(counts=counts, first_sample=7, t_ns=11, overrun=True)


@given(
    counts=hnp.arrays(np.int32, st.tuples(st.integers(0, 30), st.integers(1, 9))),
)
def test_any_counts_come_back_as_they_were(counts: np.ndarray) -> None:
    read = unpacked(WAVEFORM.cls(**packed(block(counts))))
    assert read.counts.dtype == np.int32
    assert np.array_equal(read.counts, counts)
    assert (read.first_sample, read.t_ns, read.overrun) == (7, 11, True)


def test_bytes_are_channel_after_channel_little_endian() -> None:
    fields = packed(block(np.array([[1, -1], [2, 258]], dtype=np.int32)))
    assert fields["dtype"] == "int16"
    assert fields["counts"] == bytes.fromhex("0100 0200 ffff 0201")


@pytest.mark.parametrize(("value", "dtype"), [(32767, "int16"), (-32768, "int16"), (32768, "int32"), (-32769, "int32")])
def test_sixteen_bits_are_used_only_where_they_suffice(value: int, dtype: str) -> None:
    assert packed(block(np.array([[value]], dtype=np.int32)))["dtype"] == dtype


@pytest.mark.parametrize(
    "wrong",
    [{"dtype": "float64"}, {"samples": 10**15}, {"channels": -5, "samples": -2}, {"counts": b"\0"}, {"channels": 0}],
)
def test_fields_that_contradict_one_another_are_refused(wrong: dict[str, object]) -> None:
    message = WAVEFORM.cls(**(packed(block(np.zeros((2, 5), dtype=np.int32))) | wrong))
    with pytest.raises(ValueError, match=r"dtype|counts for"):
        unpacked(message)
