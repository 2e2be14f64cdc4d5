"""One call in a process of its own while this one goes on: two cores share a design.

The other process is started as the CAD kernel's is, not by `multiprocessing`, which would run the
user's script a second time. It ends with this one, however this one ends.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

from matstd.twin.compute import one_blas_thread

CORES = os.cpu_count() or 1  # on a single one every call is made in this process
_SERVE = "from matstd.twin.beside import serve; serve()"
_WORD = 8  # bytes that state the length of a call
P = ParamSpec("P")
T = TypeVar("T")


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
    command = [sys.executable, "-c", _SERVE]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdin is not None
            process.stdin.write(len(call).to_bytes(_WORD, "big") + call)
            process.stdin.flush()  # stays open: its end is that of this process
            yield lambda: _answer(process, here)
        finally:
            process.kill()


def _packed(call: object) -> bytes:
    """A call as it is sent; nothing where it cannot be."""
    try:
        return pickle.dumps(call)
    except (pickle.PicklingError, AttributeError, TypeError):
        return b""


def _answer(process: subprocess.Popen[bytes], here: Callable[[], T]) -> T:
    """What the other process returns or raises; without an answer the call is made here."""
    assert process.stdout is not None
    data = process.stdout.read()
    if not data:  # it was killed, for its memory most likely
        return here()
    result: T
    error: Exception | None
    result, error = pickle.loads(data)  # from our own process
    if error is not None:
        raise error
    return result


def serve() -> None:
    """What the other process does: read a call, make it, write what came of it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who is asked to stop is the first process
    source = sys.stdin.buffer
    # what the call prints may not come between
    answer = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    call = source.read(int.from_bytes(source.read(_WORD), "big"))
    threading.Thread(target=_leave_at_end_of, args=(source.fileno(),), daemon=True).start()
    function, args, kwargs = pickle.loads(call)  # from our own process
    outcome: tuple[Any, Exception | None]
    try:
        with one_blas_thread():
            outcome = function(*args, **kwargs), None
    except Exception as error:
        outcome = None, error
    with answer:
        pickle.dump(outcome, answer)


def _leave_at_end_of(source: int) -> None:
    """End this process when the first one is gone."""
    # not through the buffer, whose lock the end of Python would miss
    while os.read(source, 1):
        pass
    os._exit(1)
