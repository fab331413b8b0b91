"""What a Modbus TCP link does when the two ends no longer agree where a message begins."""

import socket
import struct
import threading
from collections.abc import Iterator

import pytest

from rotorrig.rig.config.devices import ModbusTcp
from rotorrig.rig.motor.modbus_link import ModbusLink


class Deafened:
    """A device of which the first connection waits for the rest of a message that never comes; the next ones work."""

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self.connections = 0
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            self.connections += 1
            threading.Thread(target=self._answer, args=(connection, self.connections == 1), daemon=True).start()

    def _answer(self, connection: socket.socket, deaf: bool) -> None:
        with connection:
            while request := connection.recv(256):
                if (
                    not deaf
                ):  # MODBUS Messaging on TCP/IP V1.0b: transaction, protocol 0, length, unit; then 03, bytes, word
                    (transaction,) = struct.unpack_from(">H", request)
                    connection.sendall(struct.pack(">HHHBBBH", transaction, 0, 5, request[6], 3, 2, 1234))

    def close(self) -> None:
        self._listener.close()


@pytest.fixture
def device() -> Iterator[Deafened]:
    device = Deafened()
    yield device
    device.close()


def test_a_connection_that_answers_nothing_more_is_made_anew(device: Deafened) -> None:
    table = {"driver": "modbus-tcp", "host": "127.0.0.1", "tcp_port": device.port, "max_speed": 400.0}
    link = ModbusLink(ModbusTcp.model_validate(table, context={"si": True}), model="any")
    link.open()
    try:
        assert link.read(100, 1, "state") == [1234]
        assert device.connections == 2
    finally:
        link.close()
