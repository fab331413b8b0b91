"""The drawing of docs/your-rig.md: what is wired to what, with the channels of configs/rk4.toml."""

from pathlib import Path

from docs.svg_plot import COLOURS, FAINT, INK, Figure
from rotorrig.rig.config import RigConfig, load

RK4 = Path(__file__).parents[1] / "configs" / "rk4.toml"
SIGNAL, CONTROL, POWER = COLOURS[0], COLOURS[2], COLOURS[1]
LEFT, RIGHT, SHAFT = 190.0, 720.0, 96.0  # px: ends of the shaft, and its height
DAQ = (430.0, 330.0, 290.0, 64.0)
COMPUTER = (372.0, 446.0, 150.0, 50.0)
DRIVE = (24.0, 330.0, 150.0, 64.0)
DRIVERS = 214.0  # px, top of the boxes of the probes' drivers
WIDE, HIGH = 58.0, 44.0  # px, of such a box

Box = tuple[float, float, float, float]


def pictures() -> dict[str, Figure]:
    """Return the drawing by its file name."""
    rig = load(RK4)
    figure = Figure(width=780, height=540)
    figure.words(16, 26, "The rig of configs/rk4.toml; positions along the shaft are to scale", size=13)
    _shaft(figure, rig)
    _signals(figure, rig)
    _control(figure)
    figure.key_row(24, 526, [(SIGNAL, "signals"), (CONTROL, "commands"), (POWER, "power to the motor")])
    return {"wiring.svg": figure}


def _along(rig: RigConfig, z: float) -> float:
    return LEFT + (RIGHT - LEFT) * z / rig.shaft.length


def _shaft(figure: Figure, rig: RigConfig) -> None:
    """Draw motor, coupling, shaft, bearings and disks from the side."""
    figure.box((LEFT, SHAFT - 4, RIGHT - LEFT, 8), fill="#ccc", stroke=INK)
    figure.box((44, SHAFT - 28, 96, 56), fill="#eee", stroke=INK)
    figure.words(92, SHAFT + 5, "motor", anchor="middle")
    figure.box((140, SHAFT - 3, 26, 6), fill="#ccc", stroke=INK)
    figure.box((166, SHAFT - 12, 24, 24), fill="#ddd", stroke=INK)
    figure.words(168, SHAFT - 18, "coupling, z = 0", size=11)
    for bearing in rig.bearings:
        x = _along(rig, bearing.position)
        figure.path([(x - 9, SHAFT + 24), (x, SHAFT + 5), (x + 9, SHAFT + 24), (x - 9, SHAFT + 24)], colour=INK)
    figure.words(_along(rig, 0.0725), SHAFT + 42, "bearings", size=11, anchor="middle")
    figure.words(_along(rig, rig.bearings[-1].position), SHAFT + 42, rig.bearings[-1].name, size=11, anchor="middle")
    for disk in rig.disks:
        x, half = _along(rig, disk.position), disk.diameter / 2 / rig.shaft.length * (RIGHT - LEFT)
        figure.box((x - 12, SHAFT - half, 24, 2 * half), fill="#bbb", stroke=INK)
        figure.words(x + 18, SHAFT - half + 10, disk.name, size=11)


def _signals(figure: Figure, rig: RigConfig) -> None:
    """Draw every probe and the keyphasor, their drivers, and the DAQ's channels."""
    assert rig.keyphasor is not None
    sources = [(probe.name, _along(rig, probe.position), probe.channel) for probe in rig.probes]
    sources.insert(0, ("keyphasor", 232.0, rig.keyphasor.channel))
    x, y, width, _ = DAQ
    count = len(sources)
    for i, (name, place, channel) in enumerate(sources):
        driver = 224.0 + i * 92
        beside = place - 6 + 12 * (i % 2)  # x and y of a plane stand side by side
        figure.path([(beside, SHAFT + 8), (beside, SHAFT + 22)], colour=SIGNAL, width=6)
        bend = 150.0 + 8 * abs(count // 2 - i)
        figure.path([(beside, SHAFT + 22), (beside, bend), (driver, bend), (driver, DRIVERS)], colour=SIGNAL)
        _box(figure, (driver - WIDE / 2, DRIVERS, WIDE, HIGH), "driver", "-24 V")
        figure.words(driver + 4, DRIVERS - 6, name, size=12, colour=SIGNAL)
        port = x + width * (channel + 0.5) / count
        level = DRIVERS + HIGH + 14 + 8 * (count - i)
        figure.path([(driver, DRIVERS + HIGH), (driver, level), (port, level), (port, y)], colour=SIGNAL, arrow=True)
        figure.words(port + 4, y + 16, str(channel), size=12)
    _box(
        figure,
        (x, y + 20, width, DAQ[3] - 20),
        "DAQ: one clock for probes and keyphasor",
        "channel n is its input n, from 0",
    )
    figure.box(DAQ, fill="none", stroke=INK)


def _control(figure: Figure) -> None:
    """Draw the computer, the drive and the emergency stop."""
    _box(figure, COMPUTER, "computer", "rotor sweep")
    figure.path([(575, 394), (575, 471), (522, 471)], colour=SIGNAL, arrow=True)
    figure.words(582, 440, "USB or Ethernet: samples", size=12, colour=SIGNAL)
    _box(figure, DRIVE, "motor drive", "its watchdog set")
    figure.path([(372, 471), (150, 471), (150, 394)], colour=CONTROL, arrow=True)
    figure.words(160, 462, "RS-485, Ethernet, CAN or serial:", size=12, colour=CONTROL)
    figure.words(160, 488, "speed, ramp, stop", size=12, colour=CONTROL)
    figure.path([(92, 330), (92, SHAFT + 28)], colour=POWER, width=2.5, arrow=True)
    _box(figure, (24.0, 446.0, 104.0, 50.0), "emergency stop", "by hand")
    figure.path([(60, 446), (60, 394)], colour=POWER, width=2.5, arrow=True)
    figure.words(24, 420, "mains", size=11, colour=POWER)


def _box(figure: Figure, at: Box, words: str, more: str) -> None:
    x, y, width, height = at
    figure.box(at, fill="#f7f7f7", stroke=INK)
    figure.words(x + width / 2, y + height / 2 - 3, words, size=12, anchor="middle")
    figure.words(x + width / 2, y + height / 2 + 13, more, size=11, anchor="middle", colour=FAINT)
