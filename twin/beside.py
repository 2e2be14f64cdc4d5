"""One call in a process of its own while this one goes on: two cores share a design.

The other process is started as the CAD kernel's is, not by `multiprocessing`, which would run the
user's script a second time. It ends with this one, however this one ends.
"""

import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, Any, ParamSpec, TypeVar

from matstd.twin.compute import one_blas_thread

CORES = os.cpu_count() or 1  # on a single one every call is made in this process
_SERVE = "from matstd.twin.beside import serve; serve()"
_WORD = 8  # bytes that state the length of a call or of an answer
P = ParamSpec("P")
T = TypeVar("T")

_Process = subprocess.Popen[bytes]


class _Kept:
    """Processes that wait for a further call, while they are kept; None where they are not."""

    idle: list[_Process] | None = None


@contextmanager
def kept_beside() -> Iterator[None]:
    """Within it a process that has answered serves the next call: its imports are made once."""
    if _Kept.idle is not None:
        yield
        return
    idle: list[_Process] = []
    _Kept.idle = idle
    try:
        yield
    finally:
        _Kept.idle = None
        for process in idle:
            _end(process)


@contextmanager
def beside(
    function: Callable[P, T], *args: P.args, **kwargs: P.kwargs
) -> Iterator[Callable[[], T]]:
    """Begin a call of a module's function in another process; what is yielded waits for its result.

    The call is made here, when its result is asked for, on a single core, and where it cannot be
    sent: effects of a user's file exist in this process alone. What it raises is raised here.

    Example:
        >>> with beside(divmod, 7, 2) as result:
        ...     result()
        (3, 1)
    """

    def here() -> T:
        return function(*args, **kwargs)

    call = _packed((function, args, kwargs)) if CORES > 1 else b""
    if not call:
        yield here
        return
    process = _Kept.idle.pop() if _Kept.idle else _started()
    is_done = False

    def answer() -> T:
        nonlocal is_done
        assert not is_done  # asked for once: its process may serve another call
        assert process.stdout is not None
        data = _read(process.stdout)
        if not data:  # it was killed, for its memory most likely
            return here()
        is_done = True
        _free(process)
        result: T
        error: Exception | None
        result, error = pickle.loads(data)  # from our own process
        if error is not None:
            raise error
        return result

    try:
        assert process.stdin is not None
        _write(process.stdin, call)
        yield answer
    finally:
        if not is_done:
            _end(process)


def _started() -> _Process:
    command = [sys.executable, "-c", _SERVE]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)


def _free(process: _Process) -> None:
    """Keep a process that has answered, or end it."""
    if _Kept.idle is None:
        _end(process)
    else:
        _Kept.idle.append(process)


def _end(process: _Process) -> None:
    process.kill()
    with process:  # closes its pipes and waits for it
        pass


def _packed(call: object) -> bytes:
    """A call as it is sent; nothing where it cannot be."""
    try:
        return pickle.dumps(call)
    except (pickle.PicklingError, AttributeError, TypeError):
        return b""


def _write(pipe: IO[bytes], data: bytes) -> None:
    pipe.write(len(data).to_bytes(_WORD, "big"))
    pipe.write(data)
    pipe.flush()


def _read(pipe: IO[bytes]) -> bytes:
    """What was written; nothing at the end."""
    return pipe.read(int.from_bytes(pipe.read(_WORD), "big"))


def serve() -> None:
    """What the other process does: make one call after the other, write what came of each."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who is asked to stop is the first process
    # what the calls print may not come between
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    calls: queue.Queue[bytes] = queue.Queue()
    source = os.fdopen(os.dup(sys.stdin.fileno()), "rb")
    threading.Thread(target=_receive, args=(source, calls), daemon=True).start()
    while True:
        _write(answers, _outcome(calls.get()))


def _outcome(call: bytes) -> bytes:
    """What a call returns or raises; nothing of it stays in memory."""
    function, args, kwargs = pickle.loads(call)  # from our own process
    outcome: tuple[Any, Exception | None]
    try:
        with one_blas_thread():
            outcome = function(*args, **kwargs), None
    except Exception as error:
        outcome = None, error
    return pickle.dumps(outcome)


def _receive(source: IO[bytes], calls: "queue.Queue[bytes]") -> None:
    """Take calls while another one is made, and end this process when the first one is gone."""
    while call := _read(source):
        calls.put(call)
    os._exit(1)
