"""Modbus link to one device over a serial line or TCP: one exchange at a time, urgent ones first, with time-outs.

pymodbus speaks the protocol; queueing, retries and error messages are here.
"""

import contextlib
import logging
import time
from collections.abc import Callable

from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ModbusPDU

from rotorrig.rig.config import ModbusRtu, ModbusTcp
from rotorrig.rig.errors import LimitExceeded, LinkLost
from rotorrig.rig.motor.turns import Turns
from rotorrig.rig.serial_port import ReopenedPort, diagnose_port, keep_lines_when_closed

ANSWER_SECONDS = 0.1  # for a device to answer, besides the wire's own time; a busy drive takes some tens of ms
TRIES = 6  # of one exchange: a lost link is known after about a second
BUSY_SECONDS = 1.0  # for a device to be busy: half of the 2 s for which the interlock does without a pulse or a reading
BUSY_PAUSE = 0.02  # s before it is asked again; not of a stop
NETWORK_SECONDS = 0.1  # what switches and gateways may add
CONNECT_SECONDS = 1.0  # for a TCP connection
SLACK_SECONDS = 0.03
_LONGEST = 40  # bytes of a request and its answer
_BITS_PER_BYTE = 11
ILLEGAL = {
    1: "illegal function",
    2: "illegal address",
    3: "illegal value",
    4: "device failure",
    5: "still at the request before",
    6: "device busy",
    10: "no path through the gateway",
    11: "no such device behind the gateway",
}
_TRANSIENT = (5, 6)  # Modbus Application Protocol V1.1b3, section 7: the request is to be repeated

# without a handler, Python prints pymodbus' own account of every retry to stderr; errors are raised as LinkLost
logging.getLogger("pymodbus").addHandler(logging.NullHandler())


class ModbusLink:
    """The link to the device a `[motor]` table names. Its methods may be called from several threads."""

    def __init__(self, table: ModbusRtu | ModbusTcp, *, model: str) -> None:
        self._table, self._model = table, model
        self._client: ModbusSerialClient | ModbusTcpClient | None = None  # None: not open
        self._turns = Turns()
        self._given_up = 0  # how many answers were, and may still arrive
        self.answer_seconds = ANSWER_SECONDS
        self._port: ReopenedPort | None = None  # None: it is no serial port
        if isinstance(table, ModbusRtu):
            self._port = ReopenedPort(table.port)
            self.answer_seconds += _LONGEST * _BITS_PER_BYTE / table.baudrate
            self.name = f"Modbus RTU, {table.port}, {table.baudrate} baud, address {table.address}"
        else:
            self.answer_seconds += NETWORK_SECONDS
            self.name = f"Modbus TCP, {table.host}:{table.tcp_port}, unit {table.address}"

    def open(self) -> None:
        """Open the port or connect, anew if it was open. Raises LinkLost."""
        with self._turns.take():
            self._close()
            self._client = self._connect()
            self._given_up = 0

    def read(self, register: int, count: int, what: str) -> list[int]:
        """Return the words of `count` registers from `register`.

        Raises LinkLost naming the link, the register and what was asked for.
        """
        last = f" to {register + count - 1}" if count > 1 else ""
        asked = f"read {what} (register {register}{last})"

        def request(client: ModbusSerialClient | ModbusTcpClient) -> ModbusPDU:
            return client.read_holding_registers(register, count=count, device_id=self._table.address)

        reply = self._exchange(request, lambda reply: reply.function_code == 3 and len(reply.registers) == count, asked)
        return list(reply.registers)

    def write(
        self, register: int, word: int, what: str, *, urgent: bool = False, unless: Callable[[], bool] | None = None
    ) -> None:
        """Write a word, and see the device echo it. Raises LinkLost like `read`.

        An `urgent` one waits for the exchange under way and no other. If `unless` holds when it is its turn, nothing is
        sent and LimitExceeded raised: for commands that a stop from another thread has overtaken.
        """
        asked = f"write {what} = {word} (register {register})"

        def request(client: ModbusSerialClient | ModbusTcpClient) -> ModbusPDU:
            if unless and unless():
                raise LimitExceeded(f"drive: was told to stop; the command to {asked} was not sent")
            return client.write_register(register, word, device_id=self._table.address)

        def is_echo(reply: ModbusPDU) -> bool:
            return (reply.function_code, reply.address, reply.registers) == (6, register, [word])

        self._exchange(request, is_echo, asked, urgent=urgent)

    def close(self) -> None:
        """Give the port back; may be called twice."""
        with self._turns.take(first=True):
            self._close()

    def _exchange(
        self,
        request: Callable[[ModbusSerialClient | ModbusTcpClient], ModbusPDU],
        answers: Callable[[ModbusPDU], bool],
        asked: str,
        *,
        urgent: bool = False,
    ) -> ModbusPDU:
        """Ask until the device answers what was asked; each try is a turn of its own.

        It may leave `TRIES` of them without an answer, and be busy for `BUSY_SECONDS`.
        """
        if not urgent:
            self._let_late_answers_arrive()
        lost, busy_until = 0, time.monotonic() + BUSY_SECONDS
        while lost < TRIES:
            with self._turns.take(first=urgent):
                reply = self._try(request, asked, anew=lost == TRIES // 2)
            if reply is None:
                lost += 1
            elif reply.isError():
                if reply.exception_code not in _TRANSIENT or time.monotonic() > busy_until:
                    raise self._refusal(reply, asked)
                time.sleep(0.0 if urgent else BUSY_PAUSE)
            elif answers(reply):
                return reply
            else:
                self._given_up += 1
                lost += 1
        raise LinkLost(
            f"{self.name}: asked to {asked}, no valid answer in {TRIES} tries of {self.answer_seconds:.2g} s"
        )

    def _try(
        self, request: Callable[[ModbusSerialClient | ModbusTcpClient], ModbusPDU], asked: str, *, anew: bool
    ) -> ModbusPDU | None:
        """Send a request once; return the reply, None if none comes in time. Raises LinkLost if the link is gone."""
        client = self._require_client(asked)
        if anew and isinstance(self._table, ModbusTcp):
            client.close()  # after one damaged length the two ends never agree again where a message begins
            client = self._client = self._connect()
        with contextlib.suppress(ModbusException, OSError):
            return request(client)
        self._given_up += 1
        if not client.connected:
            raise LinkLost(f"{self.name}: asked to {asked}, but {self._loss}")
        return None

    def _let_late_answers_arrive(self) -> None:
        """Wait for the answers that were given up, off turn: one of RTU does not say to which question it is."""
        if given_up := self._given_up:
            time.sleep(min(given_up, TRIES) * self.answer_seconds + SLACK_SECONDS)
            self._given_up = max(0, self._given_up - given_up)

    def _require_client(self, asked: str) -> ModbusSerialClient | ModbusTcpClient:
        if self._client is None:
            raise LinkLost(f"{self.name}: asked to {asked}, but the link is not open")
        return self._client

    @property
    def _loss(self) -> str:
        return (
            "the port is gone; was it unplugged?"
            if isinstance(self._table, ModbusRtu)
            else "the connection was closed; is the drive on?"
        )

    def _refusal(self, reply: ModbusPDU, asked: str) -> LinkLost:
        reason = ILLEGAL.get(reply.exception_code, "unknown reason")
        return LinkLost(
            f"{self.name}: asked to {asked}, the device refused with exception {reply.exception_code} "
            f"({reason}); is it a {self._model}?"
        )

    def _connect(self) -> ModbusSerialClient | ModbusTcpClient:
        table = self._table
        if self._port:
            self._port.check()
        if isinstance(table, ModbusRtu):
            line = ModbusSerialClient(table.port, baudrate=table.baudrate, timeout=self.answer_seconds, retries=0)
            if not line.connect() or line.socket is None:
                raise LinkLost(f"{table.port}: the drive's port cannot be opened ({diagnose_port(table.port)})")
            keep_lines_when_closed(line.socket)
            return line
        host = ModbusTcpClient(table.host, port=table.tcp_port, timeout=CONNECT_SECONDS, retries=0)
        if not host.connect():
            raise LinkLost(
                f"{table.host}:{table.tcp_port}: nobody accepts a Modbus TCP connection there; "
                "is the drive on, and are motor.host and motor.tcp_port right?"
            )
        host.comm_params.timeout_connect = self.answer_seconds  # what pymodbus waits for an answer from here on
        return host

    def _close(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client = None
