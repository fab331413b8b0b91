"""What comes of reading a foreign file, for a test to compare, and a mapping of all channels by number."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.recording import RawRecording


def volts_of(recording: RawRecording) -> dict[str, NDArray[np.float64]]:
    """Return volts (sample,) by name."""
    counts = np.concatenate([block.counts for block in recording.blocks])
    volts = counts * np.array(recording.daq.volts_per_count)
    assert recording.rig.keyphasor
    places = {"keyphasor": recording.rig.keyphasor.channel} | {p.name: p.channel for p in recording.rig.probes}
    return {name: volts[:, place] for name, place in places.items()}


ALL = "".join(
    f'[[channels]]\nprobe = "{name}"\nchannel = {number}\nunit = "{{unit}}"\n'
    for number, name in enumerate(("keyphasor", "1x", "1y", "2x", "2y"), start=1)
)
