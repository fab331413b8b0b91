"""`Workers`: processes that call the objective side by side, in which a crash costs one point and not the search."""

import contextlib
import multiprocessing
import pickle
import signal
from collections import deque
from collections.abc import Iterator
from multiprocessing.connection import Connection, wait

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.calls.call import Objective, Outcome, call, failed_call

Array = NDArray[np.float64]

_READY = "ready"  # the first message of a process


class Workers:
    """Up to `count` processes, started when first needed and ended by `close`; each is sent `fun` once.

    A process that ends within a call (a segmentation fault, `exit`) fails that point and is replaced; the pools of the
    standard library would give up, or hang. Ctrl-C is left to the parent.
    """

    def __init__(self, fun: Objective, count: int) -> None:
        """Start nothing yet. Raises TypeError if `fun` cannot be sent to another process."""
        try:
            self._fun = pickle.dumps(fun)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise TypeError(
                f"fun cannot be sent to worker processes ({error}), expected a function that stands in a module"
            ) from None
        self._count = count
        self._idle: list[_Worker] = []
        self._busy: dict[Connection, tuple[_Worker, int]] = {}  # and the number of the point it is at

    def map(self, points: Array) -> Iterator[Outcome]:
        """Yield the outcomes at points (n, dim) in order, each as soon as it and all before it are there.

        When the iterator is left before its end, `close` must follow. Raises TypeError as `call` does, and RuntimeError
        if the processes do not start.
        """
        waiting = deque(enumerate(points))
        done: dict[int, Outcome] = {}
        for due in range(len(points)):
            while due not in done:
                self._assign(waiting)
                for pipe in wait(list(self._busy)):
                    assert isinstance(pipe, Connection)
                    self._collect(pipe, done)
                self._assign(waiting)  # before the caller is at it: no process should wait for him
            yield done.pop(due)

    def close(self) -> None:
        """End all processes: idle ones by request, busy ones at once, for nobody wants their values any more."""
        busy = [worker for worker, _ in self._busy.values()]
        for worker in self._idle:
            worker.send(None)
        for worker in busy:
            worker.kill()
        for worker in [*self._idle, *busy]:
            worker.gone()
        self._idle.clear()
        self._busy.clear()

    def _assign(self, waiting: deque[tuple[int, Array]]) -> None:
        while waiting and len(self._busy) < self._count:
            worker = self._idle.pop() if self._idle else _Worker(self._fun)
            i, point = waiting.popleft()
            self._busy[worker.pipe] = worker, i
            worker.send(point)

    def _collect(self, pipe: Connection, done: dict[int, Outcome]) -> None:
        worker, i = self._busy[pipe]
        try:
            message = pipe.recv()
        except (EOFError, OSError):
            del self._busy[pipe]
            how = f"its worker process ended with exit code {worker.gone()}"
            if not worker.ready:
                raise RuntimeError(
                    f"{how} before it was ready, expected `if __name__ == '__main__':` in a script with workers"
                ) from None
            done[i] = failed_call(how, n=1)
            return
        if message == _READY:
            worker.ready = True
            return
        del self._busy[pipe]
        self._idle.append(worker)
        if isinstance(message, TypeError):
            raise message
        done[i] = message


class _Worker:
    """One process and the pipe to it."""

    def __init__(self, fun: bytes) -> None:
        self.ready = False
        self.pipe, theirs = multiprocessing.Pipe()
        self._process = multiprocessing.Process(target=_serve, args=(theirs, self.pipe, fun), daemon=True)
        self._process.start()
        theirs.close()  # an end held on both sides would never be seen to close

    def send(self, point: Array | None) -> None:
        """Ask for a value, or for its end; if it has ended already, its pipe will say so."""
        with contextlib.suppress(OSError):
            self.pipe.send(point)

    def kill(self) -> None:
        """End it within a call."""
        self._process.kill()

    def gone(self) -> int | None:
        """Wait until it has ended; return its exit code."""
        self._process.join()
        code = self._process.exitcode
        self._process.close()
        self.pipe.close()
        return code


def _serve(pipe: Connection, theirs: Connection, pickled: bytes) -> None:
    """Answer points with their outcomes until None comes, or nobody is left to ask."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    theirs.close()
    with contextlib.suppress(EOFError, OSError):  # the parent is gone
        try:
            fun = pickle.loads(pickled)
        except Exception as error:
            pipe.send(TypeError(f"fun cannot be read by a worker process ({type(error).__name__}: {error})"))
            return
        pipe.send(_READY)
        while (point := pipe.recv()) is not None:
            try:
                answer: Outcome | TypeError = call(fun, point, n=1)
            except TypeError as error:
                answer = error
            pipe.send(answer)
