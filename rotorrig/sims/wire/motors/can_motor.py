"""A CiA 402 drive as a CANopen node, behind an slcan adapter on a tty.

SDO server, NMT and emergencies are the `canopen` library's LocalNode; what the objects mean is `Cia402`'s. Everything
happens in the event loop.
"""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import canopen
from canopen import objectdictionary as od

from rotorrig.sims.wire.cables import open_serial_end
from rotorrig.sims.wire.motors.cia402 import DICTIONARY, Cia402, Refused
from rotorrig.sims.wire.motors.slcan import Adapter

_TICK = 0.01  # s between looks at ramps and heartbeat
_HEARTBEAT = 0x700  # function code of the CAN identifier; the node is added
_TYPES = {
    "u8": od.UNSIGNED8,
    "u16": od.UNSIGNED16,
    "u32": od.UNSIGNED32,
    "i8": od.INTEGER8,
    "i16": od.INTEGER16,
    "text": od.VISIBLE_STRING,
}
_NODES = 127


@asynccontextmanager
async def serve_slcan(device: Cia402, *, port: str, node: int = 1, bitrate: int = 500_000) -> AsyncIterator[None]:
    """Be node `node` behind an slcan adapter on the tty `port`, on a bus of `bitrate`, for the length of the block."""
    served = Node(device, node)
    adapter = Adapter(bitrate=bitrate, on_frame=served.take)
    served.transmit = adapter.deliver
    async with open_serial_end(port, received=adapter.take) as send, served.alive():
        adapter.send = send
        yield


class Node:
    """The drive as a node: frames in by `take`, out by `transmit`."""

    def __init__(self, device: Cia402, node: int) -> None:
        self.transmit: Callable[[int, bytes], None] = lambda can_id, data: None
        self._device = device
        self._network = _Network(lambda can_id, data: self.transmit(can_id, data))
        self._node = canopen.LocalNode(node, _dictionary())
        self._node.add_read_callback(self._read)
        self._node.add_write_callback(self._write)
        self._network.add_node(self._node)
        device.emergency = self._node.emcy.send

    def take(self, can_id: int, data: bytes) -> None:
        """Take a frame from the bus; those of other services and other nodes are passed over."""
        if _HEARTBEAT < can_id <= _HEARTBEAT + _NODES:
            self._device.hear_heartbeat(can_id - _HEARTBEAT)
        elif (can_id == 0 and len(data) == 2) or (can_id == self._node.sdo.rx_cobid and len(data) == 8):
            self._network.notify(can_id, bytearray(data), 0.0)

    @asynccontextmanager
    async def alive(self) -> AsyncIterator[None]:
        """Boot, and tick, for the length of the block."""
        self._node.nmt.state = "INITIALISING"  # sends the boot-up message
        self._node.nmt.state = "PRE-OPERATIONAL"
        ticking = asyncio.create_task(self._tick())
        try:
            yield
        finally:
            ticking.cancel()

    async def _tick(self) -> None:
        with contextlib.suppress(asyncio.CancelledError):
            while True:
                self._device.tick()
                if self._device.master_lost and self._node.nmt.state == "OPERATIONAL":
                    self._node.nmt.state = "PRE-OPERATIONAL"  # CiA 301, error behaviour 1029h as by default
                await asyncio.sleep(_TICK)

    def _read(self, *, index: int, subindex: int, od: Any) -> int | str:
        return self._device.read(index, subindex)

    def _write(self, *, index: int, subindex: int, od: Any, data: bytes) -> None:
        try:
            self._device.write(index, subindex, od.decode_raw(data))
        except Refused as refusal:
            raise canopen.SdoAbortedError(refusal.code) from refusal


class _Network(canopen.Network):
    """The library's network with a wire of ours."""

    def __init__(self, send: Callable[[int, bytes], None]) -> None:
        super().__init__()
        self._send = send

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        self._send(can_id, bytes(data))


def _dictionary() -> od.ObjectDictionary:
    dictionary = od.ObjectDictionary()
    records: dict[int, od.ODRecord] = {}
    for (index, subindex), entry in sorted(DICTIONARY.items()):
        variable = od.ODVariable(entry.name, index, subindex)
        variable.data_type = _TYPES[entry.kind]
        variable.access_type = "ro" if entry.allowed is None else "rw"
        if (index, 1) in DICTIONARY:
            if index not in records:
                records[index] = od.ODRecord(f"{index:04X}h", index)
                dictionary.add_object(records[index])
            records[index].add_member(variable)
        else:
            dictionary.add_object(variable)
    return dictionary
