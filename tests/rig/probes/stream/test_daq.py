"""The stream DAQ over a real pty: blocks in their place in time, losses counted, every failure one sentence."""

import itertools
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

from rotorrig.rig.errors import ConfigError, LinkLost
from rotorrig.rig.probes.base import DaqCounters
from rotorrig.rig.probes.stream import daq as stream_daq
from rotorrig.rig.probes.stream import port
from rotorrig.rig.probes.stream.daq import StreamDaq
from tests.rig.wire_fakes import Board, data_frame, error_frame, info_frame, stopped_frame, wait_for

SCANS = 200
COUNTS = np.arange(SCANS * 5, dtype=np.int32).reshape(SCANS, 5) - 500
FRAMES = [data_frame(COUNTS + k, sequence=k, first_scan=SCANS * k) for k in range(6)]


@pytest.fixture
def daq(board: Board) -> Iterator[StreamDaq]:
    with StreamDaq(board.port, sample_rate=10_000.0, channels=5) as daq:
        yield daq


def test_info_is_what_the_board_says(daq: StreamDaq) -> None:
    info = daq.open()
    assert (info.model, info.sample_rate, info.channels) == ("board", 10_000.0, 5)
    assert info.volts_per_count == (24 / 32768,) * 5


def test_blocks_carry_counts_and_their_time(board: Board, daq: StreamDaq) -> None:
    board.frames = iter(FRAMES)
    daq.open()
    daq.start()
    blocks = [daq.read() for _ in FRAMES]
    assert [b.first_sample for b in blocks] == [0, 200, 400, 600, 800, 1000]
    assert [b.t_ns for b in blocks] == [0, 20_000_000, 40_000_000, 60_000_000, 80_000_000, 100_000_000]
    for k, block in enumerate(blocks):
        np.testing.assert_array_equal(block.counts, COUNTS + k)
    assert daq.counters == DaqCounters(blocks=6, samples=1200, saturated=(0,) * 5)


def test_time_is_rounded_from_the_scan_index_at_odd_rates(board: Board) -> None:
    board.info = info_frame(sample_rate_hz=10_240 / 3)
    board.frames = iter([FRAMES[0], FRAMES[1]])
    with StreamDaq(board.port, sample_rate=10_240 / 3, channels=5) as daq:
        daq.open()
        daq.start()
        daq.read()
        assert daq.read().t_ns == 58_593_750  # 200 * 3 / 10240 s


def test_a_lost_frame_is_a_gap_that_is_seen_and_counted(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], FRAMES[1], FRAMES[4]])
    daq.open()
    daq.start()
    assert [daq.read().first_sample for _ in range(3)] == [0, 200, 800]
    counted = daq.counters
    assert (counted.gaps, counted.lost_samples, counted.lost_frames, counted.overruns) == (1, 400, 2, 0)


def test_a_damaged_frame_is_a_gap_and_a_bad_frame(board: Board, daq: StreamDaq) -> None:
    damaged = FRAMES[1][:100] + b"\x55" + FRAMES[1][101:]
    board.frames = iter([FRAMES[0], damaged, FRAMES[2]])
    daq.open()
    daq.start()
    assert [daq.read().first_sample for _ in range(2)] == [0, 400]
    counted = daq.counters
    assert (counted.damaged_frames, counted.gaps, counted.lost_samples) == (1, 1, 200)
    assert counted.stray_bytes == len(damaged)


def test_an_overrun_is_told_with_its_block(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], data_frame(COUNTS, sequence=1, first_scan=5000, overrun=True)])
    daq.open()
    daq.start()
    assert not daq.read().overrun
    assert daq.read().overrun
    assert (daq.counters.overruns, daq.counters.lost_samples, daq.counters.lost_frames) == (1, 4800, 0)


def test_a_frame_that_comes_twice_is_dropped_once_and_counted(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], FRAMES[0], FRAMES[1], FRAMES[2], FRAMES[1], FRAMES[3]])
    daq.open()
    daq.start()
    assert [daq.read().first_sample for _ in range(4)] == [0, 200, 400, 600]
    assert daq.counters == DaqCounters(blocks=4, samples=800, repeated_frames=2, saturated=(0,) * 5)


def test_a_frame_out_of_order_leaves_its_gap_and_is_counted(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], FRAMES[2], FRAMES[1], FRAMES[3]])
    daq.open()
    daq.start()
    assert [daq.read().first_sample for _ in range(3)] == [0, 400, 600]
    counted = daq.counters
    assert (counted.gaps, counted.lost_samples, counted.late_frames, counted.repeated_frames) == (1, 200, 1, 0)


def test_samples_at_the_ends_of_the_range_are_counted_per_channel(board: Board, daq: StreamDaq) -> None:
    counts = COUNTS.copy()
    counts[3:10, 1] = 32767
    counts[0, 4] = -32768
    board.frames = iter([FRAMES[0], data_frame(counts, sequence=1, first_scan=200)])
    daq.open()
    daq.start()
    daq.read()
    np.testing.assert_array_equal(daq.read().counts, counts)
    assert daq.counters.saturated == (0, 7, 0, 0, 1)


def test_counters_stay_when_the_daq_is_closed(board: Board, daq: StreamDaq) -> None:
    assert daq.counters == DaqCounters()
    board.frames = iter(FRAMES[:1])
    daq.open()
    daq.start()
    daq.read()
    daq.close()
    assert daq.counters.samples == 200


def test_what_was_on_the_wire_before_the_start_is_not_counted(board: Board, daq: StreamDaq) -> None:
    board.before_info = b"boot v1.2 \xa5\x5a\x02" + FRAMES[3][5:]
    board.frames = iter(FRAMES[:1])
    daq.open()
    daq.start()
    daq.read()
    assert (daq.counters.stray_bytes, daq.counters.damaged_frames) == (0, 0)


def test_broken_counters_of_a_board_are_said(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], data_frame(COUNTS, sequence=1, first_scan=1 << 60)])
    daq.open()
    daq.start()
    daq.read()
    with pytest.raises(LinkLost, match=r"counters are broken: scan 1152921504606846976 in frame 1 after scan 199"):
        daq.read()


def test_the_sequence_number_may_wrap(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([data_frame(COUNTS, sequence=s, first_scan=200 * k) for k, s in enumerate([2**32 - 1, 0])])
    daq.open()
    daq.start()
    daq._sequence._next_sequence = 2**32 - 1  # as after 2.7 years of 20 ms frames
    daq.read()
    daq.read()
    assert daq.counters.lost_frames == 0


def test_a_second_start_begins_at_sample_zero_with_fresh_counters(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], FRAMES[2]])
    daq.open()
    daq.start()
    daq.read()
    daq.read()
    board.frames = iter(FRAMES)
    daq.start()
    assert daq.read().first_sample == 0
    assert daq.counters.gaps == 0
    assert board.commands.count("STOP") == 2


def test_a_board_that_still_streams_for_someone_else_is_taken_over(board: Board, daq: StreamDaq) -> None:
    board.before_info = FRAMES[3][50:] + FRAMES[4] + stopped_frame(1000)
    board.frames = iter(FRAMES)
    daq.open()
    daq.start()
    assert daq.read().first_sample == 0


def test_stop_and_close_may_be_called_twice(board: Board, daq: StreamDaq) -> None:
    board.frames = iter(FRAMES)
    daq.open()
    daq.start()
    daq.read()
    daq.stop()
    daq.stop()
    daq.close()
    daq.close()
    assert board.commands[-2:] == ["START", "STOP"]


def test_closing_while_streaming_stops_the_board(board: Board, daq: StreamDaq) -> None:
    daq.open()
    daq.start()
    daq.close()
    wait_for(lambda: board.commands[-1] == "STOP")


def test_the_port_is_free_again_after_close(board: Board, daq: StreamDaq) -> None:
    daq.open()
    daq.close()
    assert daq.open().model == "board"


def test_a_slow_reader_loses_nothing(board: Board, daq: StreamDaq) -> None:
    frames = (data_frame(COUNTS, sequence=k, first_scan=SCANS * k) for k in itertools.count())
    board.frames = itertools.islice(frames, 120)  # more than the queue and the pty hold
    daq.open()
    daq.start()
    time.sleep(0.5)
    assert [daq.read().first_sample for _ in range(120)] == list(range(0, 120 * SCANS, SCANS))
    assert daq.counters.gaps == 0


def refusal(daq: StreamDaq) -> str:
    with pytest.raises((LinkLost, ConfigError)) as error:
        daq.open()
    assert "\n" not in str(error.value)
    return str(error.value)


def test_another_sample_rate_than_the_configs_is_refused(board: Board) -> None:
    board.info = info_frame(sample_rate_hz=10_000.02)
    said = refusal(StreamDaq(board.port, sample_rate=10_000.0, channels=5))
    assert "daq.sample_rate: got 10000 Hz in the config, want 10000.02 Hz as the DAQ 'board'" in said


def test_a_sample_rate_within_a_millionth_is_the_same(board: Board) -> None:
    board.info = info_frame(sample_rate_hz=10_000.009)
    with StreamDaq(board.port, sample_rate=10_000.0, channels=5) as daq:
        assert daq.open().sample_rate == 10_000.009


def test_too_few_channels_are_refused(board: Board) -> None:
    said = refusal(StreamDaq(board.port, sample_rate=10_000.0, channels=6))
    assert "channel 5: is named in the config, but the DAQ 'board'" in said
    assert "has 5 channels, want at least 6" in said


def test_another_protocol_is_refused(board: Board, daq: StreamDaq) -> None:
    board.info = info_frame(protocol=2)
    assert refusal(daq) == f"{board.port}: the DAQ's answer cannot be used: INFO.protocol: got 2, want 1, " + (
        "the only one this program speaks"
    )


def test_a_silent_port_is_said(board: Board, daq: StreamDaq, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_daq, "ANSWER_SECONDS", 0.5)
    board.deaf = True
    assert refusal(daq) == f"{board.port}: asked 'ID?', no DAQ answered in 0.5 s"


def test_another_kind_of_device_is_guessed_from_its_noise(
    board: Board, daq: StreamDaq, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stream_daq, "ANSWER_SECONDS", 0.5)
    board.info = b"ERROR: unknown command\r\n"
    assert refusal(daq).endswith("(24 bytes came that are no frame; is it another device?)")


def test_a_complaint_of_the_board_is_passed_on(board: Board, daq: StreamDaq, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_daq, "ANSWER_SECONDS", 0.5)
    board.info = error_frame("ADC not ready")
    assert "it says 'ADC not ready'" in refusal(daq)


def test_a_port_that_is_not_there_is_said() -> None:
    said = refusal(StreamDaq("/dev/ttyNOSUCH", sample_rate=10_000.0, channels=5))
    assert said.startswith("/dev/ttyNOSUCH: the DAQ's port cannot be opened (no such port; ports found: ")


def test_a_port_in_use_is_said(board: Board, daq: StreamDaq) -> None:
    daq.open()
    assert "in use by another program" in refusal(StreamDaq(board.port, sample_rate=10_000.0, channels=5))


def test_silence_is_a_lost_link(board: Board, daq: StreamDaq) -> None:
    board.frames = iter(FRAMES[:1])
    daq.open()
    daq.start()
    daq.read()
    with pytest.raises(LinkLost, match=r"no samples from the DAQ for 0\.2 s$"):
        daq.read(timeout=0.2)


def test_a_process_held_up_for_longer_than_it_waits_loses_no_frame(
    board: Board, daq: StreamDaq, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped and continued, it finds its time over and what the port has kept for it."""
    board.frames = iter(FRAMES)
    daq.open()
    daq.start()
    now, wait, held_up = time.monotonic, port.FramePort.next_frame, [0.0]

    def wait_stopped(self: port.FramePort, timeout: float) -> object:
        if held_up[0]:
            return wait(self, timeout)
        held_up[0] = 3.0
        return None

    monkeypatch.setattr(port.FramePort, "next_frame", wait_stopped)
    monkeypatch.setattr(time, "monotonic", lambda: now() + held_up[0])
    assert [daq.read(2.0).first_sample for _ in FRAMES] == [0, 200, 400, 600, 800, 1000]


def test_a_cut_wire_is_a_lost_link_at_once(board: Board, daq: StreamDaq) -> None:
    board.frames = iter(FRAMES[:1])
    daq.open()
    daq.start()
    daq.read()
    cutter = threading.Timer(0.1, board.unplug)
    cutter.start()
    began = time.monotonic()
    with pytest.raises(LinkLost, match="the DAQ is gone, was it unplugged"):
        daq.read(timeout=10)
    assert time.monotonic() - began < 5
    cutter.join()
    with pytest.raises(LinkLost):
        daq.stop()


def test_a_board_that_restarts_is_noticed(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], FRAMES[1], FRAMES[0]])
    daq.open()
    daq.start()
    daq.read()
    daq.read()
    with pytest.raises(LinkLost, match="went back to scan 0 after 400; has it restarted"):
        daq.read()


def test_a_board_that_stops_by_itself_is_noticed(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([FRAMES[0], stopped_frame(200)])
    daq.open()
    daq.start()
    daq.read()
    with pytest.raises(LinkLost, match="the DAQ stopped by itself after 200 scans"):
        daq.read()


def test_a_stop_confirmed_twice_does_not_end_the_next_stream(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([stopped_frame(7), FRAMES[0]])
    daq.open()
    daq.start()
    assert daq.read().first_sample == 0


def test_other_channels_than_announced_are_refused(board: Board, daq: StreamDaq) -> None:
    board.frames = iter([data_frame(COUNTS[:, :4], sequence=0, first_scan=0)])
    daq.open()
    daq.start()
    with pytest.raises(LinkLost, match="sent 4 channels, want the 5 it named"):
        daq.read()


def test_a_stop_that_is_not_confirmed_is_said(board: Board, daq: StreamDaq, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_daq, "STOP_SECONDS", 0.2)
    daq.open()
    daq.start()
    board.stubborn = True
    with pytest.raises(LinkLost, match=r"asked the DAQ to stop, no answer in 0\.2 s"):
        daq.stop()


def test_the_beginning_of_a_frame_that_never_ends_does_not_hide_the_next(
    board: Board, daq: StreamDaq, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(port, "PAUSE_SECONDS", 0.1)
    board.before_info = b"\xa5\x5a\x01\x00\xff\xff"  # an INFO of 65535 bytes
    assert daq.open().model == "board"


def test_reading_before_start_is_said(daq: StreamDaq) -> None:
    with pytest.raises(LinkLost, match=r"not streaming, want start\(\) first"):
        daq.read()
    with pytest.raises(LinkLost, match="port is not open"):
        daq.start()


def test_no_thread_is_left_behind(board: Board, daq: StreamDaq) -> None:
    daq.open()
    daq.close()
    assert not [t for t in threading.enumerate() if t.name.startswith("DAQ")]
