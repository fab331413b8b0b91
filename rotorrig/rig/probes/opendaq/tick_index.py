"""Sample index of a packet, from the tick of the device's clock it carries."""

from rotorrig.rig.errors import LinkLost

LONGEST_GAP = 3600.0  # s; a jump beyond is no gap but a clock that was set
MARGIN = 1 << 20  # samples by which a channel may begin before the first packet seen


class TickIndex:
    """Samples are `delta` ticks apart and counted from a place before the first packet; `sample_rate` in Hz."""

    def __init__(self, *, delta: int, sample_rate: float, channels: int) -> None:
        self._delta = delta
        self._longest_gap = LONGEST_GAP * sample_rate
        self._origin: int | None = None  # tick of sample 0
        self._next = [0] * channels  # the sample that should come next
        self._fault: str | None = None  # what ended the stream

    def first(self, channel: int, *, tick: int, samples: int) -> int:
        """Return the index of the first of so many samples.

        Raises LinkLost if the clock went back, or far ahead; then on every later call too, from any channel.
        """
        if self._fault is not None:
            raise LinkLost(self._fault)
        if self._origin is None:
            self._origin = tick - MARGIN * self._delta
        first = round((tick - self._origin) / self._delta)
        expected = self._next[channel]
        if first < expected or (expected and first - expected > self._longest_gap):
            self._fault = (
                f"the device's clock went {'back' if first < expected else 'ahead'} by "
                f"{abs(first - expected)} samples; has it restarted, or was its clock set?"
            )
            raise LinkLost(self._fault)
        self._next[channel] = first + samples
        return first
