"""Bytes to damaged bytes: what a bad disk, a cut transfer or an ill-meaning person makes of a file. Seeded."""

import re
from collections.abc import Callable, Sequence

import numpy as np

LONGEST = 65_536  # bytes of a mutated input
_NUMBERS = (
    b"0", b"-1", b"1e308", b"-1e999", b"nan", b"inf", b"1e-320", b"65536", b"4294967295", b"18446744073709551616",
    b"9" * 400, b"1" + b"0" * 5000, b"0x10", b"1_0", b"+", b"", b"1e", "٣".encode(), b"true", b"\"1 m\"", b"9**9**9",
)  # fmt: skip
_TOKENS = (
    b"\n", b"\r\n", b"\0", b"    -1\n", b"    58\n", b",", b";", b"\"", b"[[channels]]\n", b"[", b"{", b"'" * 3, b"#",
    b"RIFF", b"data", b"TDSm", b"\x89MCAP0\r\n", b"\xff\xfe", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"../../x", b"<script>",
    b" " * 300, b"[" * 300, b"%s%n", b"NONE", b"1 V", b"1 um", b"(1 m)**9", b"nan", b"\xa5\x5a", b"\x28\xb5\x2f\xfd",
)  # fmt: skip
_INTEGERS = (
    0,
    1,
    2,
    3,
    7,
    127,
    128,
    255,
    256,
    32767,
    65535,
    2**24,
    2**31 - 1,
    2**31,
    2**32 - 1,
    2**40,
    2**63,
    2**64 - 1,
)
_DIGITS = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")

Mutation = Callable[[bytearray, np.random.Generator, Sequence[bytes]], None]


def mutated(seeds: Sequence[bytes], rng: np.random.Generator) -> bytes:
    """Return one of `seeds`, changed in a few ways; now and then as it is."""
    data = bytearray(seeds[rng.integers(len(seeds))])
    for _ in range(int(rng.geometric(0.6)) - int(rng.random() < 0.02)):
        _MUTATIONS[rng.integers(len(_MUTATIONS))](data, rng, seeds)
    return bytes(data[:LONGEST])


def _flip_bit(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    if data:
        data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))


def _set_byte(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    if data:
        data[rng.integers(len(data))] = int(rng.integers(256))


def _set_integer(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    width = int(rng.choice([2, 4, 8]))
    if len(data) >= width:
        at = int(rng.integers(len(data) - width + 1))
        value = _INTEGERS[rng.integers(len(_INTEGERS))] & (256**width - 1)
        data[at : at + width] = value.to_bytes(width, "little" if rng.random() < 0.8 else "big")


def _set_number(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    """Put another number where one is written in digits."""
    found = list(_DIGITS.finditer(data))
    if found:
        place = found[rng.integers(len(found))].span()
        data[place[0] : place[1]] = _NUMBERS[rng.integers(len(_NUMBERS))]


def _insert_token(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    at = int(rng.integers(len(data) + 1))
    data[at:at] = _TOKENS[rng.integers(len(_TOKENS))]


def _cut(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    del data[int(rng.integers(len(data) + 1)) :]


def _remove(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    begin, end = _stretch(data, rng)
    del data[begin:end]


def _repeat(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    begin, end = _stretch(data, rng)
    data[end:end] = data[begin:end] * int(rng.choice([1, 2, 20]))


def _shuffle(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    begin, end = _stretch(data, rng)
    data[begin:end] = rng.permutation(np.array(data[begin:end], dtype=np.uint8)).tobytes()


def _splice(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    """Go on with the rest of another seed."""
    other = seeds[rng.integers(len(seeds))]
    data[int(rng.integers(len(data) + 1)) :] = other[int(rng.integers(len(other) + 1)) :]


def _remove_line(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    lines = bytes(data).splitlines(keepends=True)
    if lines:
        del lines[rng.integers(len(lines))]
        data[:] = b"".join(lines)


def _swap_lines(data: bytearray, rng: np.random.Generator, seeds: Sequence[bytes]) -> None:
    lines = bytes(data).splitlines(keepends=True)
    if lines:
        a, b = rng.integers(len(lines), size=2)
        lines[a], lines[b] = lines[b], lines[a]
        data[:] = b"".join(lines)


def _stretch(data: bytearray, rng: np.random.Generator) -> tuple[int, int]:
    begin = int(rng.integers(len(data) + 1))
    return begin, min(len(data), begin + int(2 ** rng.uniform(0, 10)))


_MUTATIONS: tuple[Mutation, ...] = (
    _flip_bit, _set_byte, _set_integer, _set_integer, _set_number, _set_number, _insert_token, _cut, _remove, _repeat,
    _shuffle, _splice, _remove_line, _swap_lines,
)  # fmt: skip
