"""What is wrong with a row, and nothing said of a sound one: waveforms whose fault was put there by hand."""

from collections.abc import Callable

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.processing.rows.quality import aliased_orders, join_remarks, probe_faults
from rotorrig.processing.rows.rows import Rows
from rotorrig.processing.settings import Tracking
from rotorrig.processing.waveform import Stretch
from rotorrig.rig.config.description import RigConfig
from tests.processing.synthetic import chirp

RPM = np.pi / 30
FULL_SCALE = 32768
VOLTS = 10.0 / FULL_SCALE * 2.4  # per count: a 16-bit converter of 24 V


def faults(rig: RigConfig, *volts: np.ndarray, per_count: float = VOLTS) -> list[str]:
    """Return what is said of probes that read `volts` (sample,), as a converter of `per_count` [V] gives them."""
    probes = rig.probes[: len(volts)]
    counts = np.stack([np.clip(np.round(v / per_count), -FULL_SCALE, FULL_SCALE - 1) for v in volts], axis=1)
    x = (counts * per_count - [p.gap_voltage for p in probes]) / [p.sensitivity for p in probes]
    stretch = Stretch(t=np.arange(len(counts)) / 5000.0, counts=counts.astype(np.int32), x=x)
    return probe_faults(stretch, probes=probes, full_scale=FULL_SCALE)


def wave(amplitude: float = 2.0, *, mean: float = -10.0, samples: int = 400, turns: int = 8) -> np.ndarray:
    """Return volts of a cosine, `samples` to a turn."""
    return mean + amplitude * np.cos(2 * np.pi * np.arange(turns * samples) / samples + 0.3)


@pytest.mark.parametrize("amplitude", [0.02, 0.2, 2.0, 7.9])
@pytest.mark.parametrize("samples", [20, 400, 5000])
@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_nothing_is_said_of_a_sound_waveform(
    rk4: RigConfig, rng: np.random.Generator, amplitude: float, samples: int, noise: float
) -> None:
    x = wave(amplitude, samples=samples)
    assert faults(rk4, x + noise * rng.standard_normal(len(x))) == [""]


def test_one_high_crest_that_noise_has_made_flat_is_not_taken_for_clipped(rk4: RigConfig) -> None:
    """Of a sweep through the critical speed: 5 of the 8 samples within ten steps of the top are on it, by chance."""
    lower = wave(-1.3, mean=-10.0, samples=270, turns=7)
    crest = [-11950, -11944, -11938, -11928, -11927, -11924, *5 * [-11915], -11919, -11920, -11927, -11931, -11939]
    highest = wave(-1.3, mean=-10.0, samples=270, turns=1) - 0.03
    at = int(highest.argmax())
    per_count, down = 0.000732421875, -10.0 + 1.25
    steps = np.array(crest) - max(crest)
    highest = np.minimum(highest, down - 0.01)
    highest[at - 8 : at + 8] = down + steps * per_count
    said = faults(rk4, np.concatenate([np.minimum(lower, down - 0.02), highest]), per_count=per_count)
    assert said == [""]


def test_clipping_at_the_end_of_the_range_is_said(rk4: RigConfig) -> None:
    low = -FULL_SCALE * VOLTS
    assert faults(rk4, np.maximum(wave(2.0, mean=low + 1.5), low)) == ["clipped"]


@pytest.mark.parametrize("at", [-8.1, -8.6, -9.5])
def test_a_flat_top_short_of_the_range_is_said_with_its_voltage(rk4: RigConfig, at: float) -> None:
    sound = wave(2.0)
    said = faults(rk4, np.minimum(sound, at), np.maximum(sound, -20.0 - at), sound)
    assert said == [
        f"clipped at {at:.2f} V, short of the DAQ's range",
        f"clipped at {-20 - at:.2f} V, short of the DAQ's range",
        "",
    ]


def test_a_file_with_few_digits_is_not_taken_for_clipped(rk4: RigConfig) -> None:
    rounded = np.round(wave(0.5), 2)  # hundredths of a volt where a count is a thousandth
    assert faults(rk4, rounded, per_count=1e-3) == [""]


def test_a_channel_that_stays_where_it_is_has_no_signal(rk4: RigConfig) -> None:
    assert faults(rk4, np.zeros(500), wave()[:500]) == ["no signal, stays at 0.00 V", ""]


@pytest.mark.parametrize("mean", [-17.0, -3.0])
def test_a_gap_out_of_the_linear_range_is_said(rk4: RigConfig, mean: float) -> None:
    assert faults(rk4, wave(2.0, mean=mean)) == ["gap out of range"]


def rows_at(*rpm: float) -> Rows:
    n = len(rpm)
    zero = np.zeros(n)
    return Rows(
        turns=8, run=np.zeros(n, dtype=np.intp), first_turn=zero, begin=zero, end=zero, t=zero,
        omega=np.array(rpm) * RPM, alpha=zero,
    )  # fmt: skip


def test_an_order_beyond_the_sample_rate_is_said_to_be_unknown() -> None:
    beyond, remarks = aliased_orders(rows_at(1200, 6000), (1.0, -8.0, 20.0), rate=2560.0)
    np.testing.assert_array_equal(beyond, [[False, False, False], [False, False, True]])  # 2000 Hz of 1000
    assert remarks == ((), ("20X is not known: 2000 Hz, beyond the 1000 Hz that 2560 Hz carry",))


def test_of_an_order_beyond_the_sample_rate_there_is_no_vector_and_the_others_stay(
    record: Callable[..., RawRecording],
) -> None:
    rate = 1000.0
    t = np.arange(int(40 * rate)) / rate
    angle = chirp(t, start=600 * RPM, rate=30 * RPM, theta_0=-0.3)
    x = np.tile(20e-6 * np.cos(angle)[:, None], 4)
    x += 1e-6 * np.cos(18 * angle)[:, None] + 1e-8 * np.random.default_rng(1).standard_normal(x.shape)
    found = track(record(angle, x, rate=rate, marks=[(0.0, "up")]), Tracking(orders=(1.0, 18.0)))
    unknown = np.isnan(found.order(18.0)).any(axis=1)
    np.testing.assert_array_equal(unknown, 18 * found.omega / (2 * np.pi) > rate / 2.56)
    assert found.usable.all() and 0 < unknown.sum() < len(unknown)
    assert np.isfinite(found.order(1.0)).all()
    assert all(bool(words) == gone for words, gone in zip(found.remarks, unknown, strict=True))


def test_a_dead_and_a_flat_probe_are_masked_alone(record: Callable[..., RawRecording]) -> None:
    rate = 5000.0
    t = np.arange(int(20 * rate)) / rate
    angle = chirp(t, start=600 * RPM, rate=20 * RPM, theta_0=-0.3)
    x = np.tile(200e-6 * np.cos(angle)[:, None], 4) + 1e-8 * np.random.default_rng(1).standard_normal((len(t), 4))
    x[:, 1] = np.minimum(x[:, 1], 150e-6)
    x[:, 2] = 0.0
    found = track(record(angle, x, rate=rate, marks=[(0.0, "up")]))
    assert found.usable.all(axis=0).tolist() == [True, False, False, True]
    assert set(found.reasons) == {
        ("1y: clipped at -8.82 V, short of the DAQ's range", "2x: no signal, stays at -10.00 V")
    }


def test_words_of_a_row_are_put_together_in_order() -> None:
    assert join_remarks((("a",), ()), ((), ("b", "c")), (("d",), ("e",))) == (("a", "d"), ("b", "c", "e"))


def test_a_recording_of_no_moving_probe_at_all_is_masked_and_not_refused(record: Callable[..., RawRecording]) -> None:
    rate = 5000.0
    t = np.arange(int(20 * rate)) / rate
    angle = chirp(t, start=600 * RPM, rate=20 * RPM, theta_0=-0.3)
    found = track(record(angle, np.zeros((len(t), 4)), rate=rate, marks=[(0.0, "up")]))
    assert not found.usable.any() and np.isfinite(found.covariance).all()
