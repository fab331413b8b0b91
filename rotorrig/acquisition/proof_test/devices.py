"""Devices of a proof test, opened anew for each part: a drive that remembers a trip is cleared in between."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from typing import Protocol

from rotorrig.acquisition.sweep import reading_interval
from rotorrig.rig import connect
from rotorrig.rig.config import RigConfig
from rotorrig.rig.control import PERSIST, GuardedControl, MotorControl, guardian_log
from rotorrig.rig.motor import MotorInfo
from rotorrig.rig.probes import Daq, DaqInfo


@dataclass(frozen=True, slots=True, kw_only=True)
class Opened:
    """Devices that answer, with the rotor at rest."""

    control: MotorControl
    drive: MotorInfo
    daq: Daq
    info: DaqInfo


class Devices(Protocol):
    """Where the devices of a test come from."""

    guardian: float | None  # s without a processed sample that the guardian allows; None: there is no guardian

    def open(self) -> AbstractContextManager[Opened]:
        """Open them for the length of a `with` block. Raises LinkLost."""
        ...

    def clear_fault(self) -> str:
        """Clear the trip that the drive remembers; return it. Raises LinkLost, LimitExceeded if it stays."""
        ...


class RigDevices:
    """The config's devices, or those of a simulated rig at other places."""

    def __init__(
        self,
        rig: RigConfig,
        *,
        guardian: float,
        persist: float = PERSIST,
        motor_at: connect.Place | None = None,
        daq_at: connect.Place | None = None,
    ) -> None:
        """`persist` [s] is how long the guardian goes on stopping a rotor that nobody looks after."""
        self.guardian: float | None = guardian
        self._rig, self._persist, self._motor_at, self._daq_at = rig, persist, motor_at, daq_at

    @contextmanager
    def open(self) -> Iterator[Opened]:
        """Open them for the length of a `with` block. Raises LinkLost."""
        assert self.guardian is not None
        table = connect.motor_table(self._rig, at=self._motor_at)
        with ExitStack() as stack:
            daq = stack.enter_context(connect.daq(self._rig, at=self._daq_at))
            info = daq.open()
            control = GuardedControl(
                self._rig,
                log=guardian_log(table),
                at=self._motor_at,
                every=reading_interval(self._rig),
                patience=self.guardian,
                persist=self._persist,
            )
            stack.callback(control.close)
            drive = control.open()  # last: from here on its watchdog must be fed
            yield Opened(control=control, drive=drive, daq=daq, info=info)

    def clear_fault(self) -> str:
        """Clear the trip that the drive remembers; return it. Raises LinkLost, LimitExceeded if it stays."""
        with connect.motor(self._rig, at=self._motor_at) as motor:
            motor.open()
            if fault := motor.read().fault:
                motor.clear_fault()
            return fault
