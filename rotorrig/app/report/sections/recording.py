"""What the recording itself shows, before any order was tracked: its cascade, and time bases with their orbits."""

from collections.abc import Iterable
from html import escape
from itertools import groupby

from rotorrig.app.plot_data import SpeedSpectra, TimeBase, nice, speed_spectra, time_bases
from rotorrig.app.report.drawings import time_base_picture
from rotorrig.app.report.figures import cascade
from rotorrig.app.report.html import Section, paragraph, plot, section
from rotorrig.processing import OrderTrackedResponse, Waveforms


def cascade_section(response: OrderTrackedResponse, waveforms: Waveforms | None) -> Section | None:
    """Return the spectra over speed of every place and run; None without a recording or a run whose speed changes."""
    spectra = speed_spectra(response, waveforms) if waveforms else ()
    if not spectra:
        return None
    top = nice(max(one.largest[0] for one in spectra))
    by_place = sorted(spectra, key=lambda one: [each.place for each in spectra].index(one.place))
    plots = [
        plot(
            f"cascade-{i}",
            cascade(one, top=top),
            caption=f"{one.place}, {one.run}: µm 0-peak, logarithmic",
            label=f"Map of the amplitude over frequency and speed, {one.place}, {one.run} run. {_largest(one)}",
            share=0.5,
        )
        for i, one in enumerate(by_place)
    ]
    note = paragraph(_CASCADE, _SIDES if any(one.full for one in spectra) else "", _window(spectra))
    return section("cascade", "Cascade: spectra over speed", note, f'<div class="pair">{"".join(plots)}</div>')


def _largest(one: SpeedSpectra) -> str:
    size, hertz, rpm = one.largest
    return f"Largest: {size:.3g} µm at {hertz:.1f} Hz and {rpm:.0f} rpm, {60 * hertz / rpm:+.2g}X."


def _window(spectra: Iterable[SpeedSpectra]) -> str:
    """Say how a spectrum was made, run by run."""
    runs = {one.run: f"{one.run} {one.seconds:.2g} s, which resolve {one.resolution:.2g} Hz" for one in spectra}
    step = next(iter(spectra)).step
    return (
        f"Stretches under a Hann window: {'; '.join(runs.values())}. A point of the map is the largest amplitude in "
        f"{step:.2g} Hz; of a line that keeps its frequency it is right to 0.3 %."
    )


def time_base_section(response: OrderTrackedResponse, waveforms: Waveforms | None) -> Section | None:
    """Return raw and 1X orbits and time bases at a few speeds; None without a recording, or a plane of two probes."""
    bases = time_bases(response, waveforms) if waveforms else ()
    if not bases:
        return None
    parts = [
        f"<h3>{escape(plane)}</h3>{''.join(time_base_picture(base) for base in mine)}"
        for plane, mine in groupby(bases, key=_plane)
    ]
    return section("time-base", "Time base and orbits as recorded", paragraph(_TIME_BASE), *parts)


def _plane(base: TimeBase) -> str:
    return base.plane.name


_CASCADE = (
    "From the recording, not from tracked orders. What unbalance drives lies on the line 1X and is brightest at a "
    "critical speed; an upright line is a frequency of its own: a natural frequency that is excited, a whirl locked to "
    "one, the mains."
)
_SIDES = "Two probes in a plane tell forward whirl, with the rotation, from backward whirl."
_TIME_BASE = (
    "Grey is raw: unfiltered and with the slow roll, its mean taken out. Blue is the 1X vector of the same turns, slow "
    "roll included. A dot is a keyphasor edge."
)
