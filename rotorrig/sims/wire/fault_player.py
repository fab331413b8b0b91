"""Player of fault scripts: begins and ends each fault in its time, and reports it."""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from rotorrig.rig import ConfigError
from rotorrig.sims.wire.cables import Interference
from rotorrig.sims.wire.drive import Drive
from rotorrig.sims.wire.fault_script import (
    DaqOverrun,
    Device,
    Disconnect,
    DriveFault,
    Fault,
    KeyphasorLost,
    Script,
    Silent,
    StuckSpeed,
    WrongDevice,
)
from rotorrig.sims.wire.inputs import Inputs
from rotorrig.sims.wire.plant_port import Plant

Report = Callable[[dict[str, Any]], None]
_LOOK = 0.01  # s of wall time between looks: time may stand still while a link's fault goes on


class Link(Protocol):
    """A cable that can be disturbed, unplugged and swapped."""

    interference: Interference

    def unplug(self, unplugged: bool) -> None:
        """Take the port away, or give it back."""
        ...

    def divert(self, diverted: bool) -> None:
        """Connect the client to another device, or back to this one."""
        ...


class Disguise(Protocol):
    """The address a controller puts into its replies."""

    answers_as: int | None  # None: its own


@dataclass(frozen=True, slots=True, kw_only=True)
class Targets:
    """Parts of the bench that faults act on."""

    motor: Link
    daq: Link
    drive: Drive
    inputs: Inputs
    disguise: Disguise | None  # of a controller that has an address

    def link(self, on: Device) -> Link:
        """Return the cable of a device."""
        return self.motor if on == "motor" else self.daq

    def start_fault(self, fault: Fault, rng: np.random.Generator) -> Callable[[], dict[str, Any]]:
        """Begin a fault; return a function that ends it and returns its effects."""
        match fault:
            case StuckSpeed():
                return _switch_on(self.drive.hold_speed)
            case DriveFault():
                self.drive.trip(fault.code)
                return dict
            case DaqOverrun():
                before = self.inputs.overrun(True)
                return lambda: {"scans": self.inputs.overrun(False) - before}
            case KeyphasorLost():
                return _switch_on(self.inputs.lose_keyphasor)
            case Silent():
                return _switch_on(self.link(fault.on).interference.silence)
            case Disconnect():
                return _switch_on(self.link(fault.on).unplug)
            case WrongDevice(address=int() as address):
                return _switch_on(partial(self._answer_as, address))
            case WrongDevice():
                return _switch_on(self.link(fault.on).divert)
            case _:
                interference = self.link(fault.on).interference
                interference.begin(fault, rng)
                return lambda: {"hits": interference.end(fault)}

    def _answer_as(self, address: int, worn: bool) -> None:
        assert self.disguise
        self.disguise.answers_as = address if worn else None


@dataclass(slots=True, kw_only=True, eq=False)
class _ScheduledFault:
    """One fault of a script: waiting, acting, over."""

    number: int  # in its script
    fault: Fault
    rng: np.random.Generator
    due: float  # s, simulated
    began: tuple[float, float] | None = None  # s, simulated and wall
    end: Callable[[], dict[str, Any]] | None = None


class Player:
    """Begins and ends faults; `look` is to be called as simulated time passes, `run` sees to those in wall time.

    Reports are tables: `t` [s, simulated], `wall` [s, this machine's monotonic clock], the fault's `number` in its
    script, `kind` and `on`, `event` "begins" or "ends", and with the end of a fault of messages its `hits`.
    """

    def __init__(self, targets: Targets, *, plant: Plant, report: Report) -> None:
        self._targets, self._plant, self._report = targets, plant, report
        self._waiting: list[_ScheduledFault] = []
        self._acting: list[_ScheduledFault] = []

    def check(self, script: Script) -> None:
        """Raise ConfigError for a fault that this controller cannot have."""
        for number, fault in enumerate(script.faults):
            if isinstance(fault, WrongDevice) and fault.address is not None and not self._targets.disguise:
                raise ConfigError(
                    f"faults[{number}].address: got {fault.address}, want none: this controller has no Modbus address"
                )

    def play(self, script: Script) -> None:
        """Take up a checked script, whose time begins now."""
        if script.calm:
            self._calm()
        seeds = np.random.SeedSequence(script.seed).spawn(len(script.faults))
        for number, (fault, seed) in enumerate(zip(script.faults, seeds, strict=True)):
            rng, due = np.random.default_rng(seed), self._plant.t + fault.at
            self._waiting.append(_ScheduledFault(number=number, fault=fault, rng=rng, due=due))
        self.look()

    def look(self) -> None:
        """Begin what is due and end what is over."""
        if not self._waiting and not self._acting:
            return
        for scheduled in [p for p in self._waiting if self._is_due(p)]:
            self._waiting.remove(scheduled)
            self._begin(scheduled)
        for scheduled in [p for p in self._acting if self._is_over(p)]:
            self._acting.remove(scheduled)
            self._end(scheduled)

    def _calm(self) -> None:
        """End what has begun, and forget what has not."""
        self._waiting.clear()
        while self._acting:
            self._end(self._acting.pop())

    async def run(self) -> None:
        """Look now and then, until cancelled."""
        while True:
            self.look()
            await asyncio.sleep(_LOOK)

    def _is_due(self, scheduled: _ScheduledFault) -> bool:
        fault = scheduled.fault
        return self._plant.t >= scheduled.due and (fault.above is None or self._plant.speed > fault.above)

    def _is_over(self, scheduled: _ScheduledFault) -> bool:
        fault = scheduled.fault
        assert scheduled.began
        match fault:
            case DriveFault():
                return True  # a moment's: the drive remembers it
            case StuckSpeed() | DaqOverrun() | KeyphasorLost():
                gone = self._plant.t - scheduled.began[0]
            case Silent() | Disconnect() | WrongDevice():
                gone = time.monotonic() - scheduled.began[1]
            case _:
                if self._targets.link(fault.on).interference.is_spent(fault):
                    return True
                gone = time.monotonic() - scheduled.began[1]
        return fault.lasts is not None and gone >= fault.lasts

    def _begin(self, scheduled: _ScheduledFault) -> None:
        scheduled.began = self._plant.t, time.monotonic()
        scheduled.end = self._targets.start_fault(scheduled.fault, scheduled.rng)
        self._acting.append(scheduled)
        self._report_event(scheduled, "begins")

    def _end(self, scheduled: _ScheduledFault) -> None:
        assert scheduled.end
        self._report_event(scheduled, "ends", **scheduled.end())

    def _report_event(self, scheduled: _ScheduledFault, event: str, **effects: Any) -> None:
        fault = scheduled.fault
        moment = {"t": round(self._plant.t, 6), "wall": time.monotonic()}
        self._report(moment | {"fault": scheduled.number, "kind": fault.kind, "on": fault.on, "event": event} | effects)


def _switch_on(switch: Callable[[bool], None]) -> Callable[[], dict[str, Any]]:
    """Switch something on; return a function that switches it off."""

    def off() -> dict[str, Any]:
        switch(False)
        return {}

    switch(True)
    return off
