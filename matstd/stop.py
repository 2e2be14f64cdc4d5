"""Ends a command when it is asked to, tidily and within a second."""

import os
import shutil
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

STOPPED = 130
"""Exit code of a command that was asked to stop."""

PATIENCE = 0.4
"""Seconds that the command has to come to an end by itself: with what follows, less than one."""


class _Asked:
    """Whether somebody asked the command to stop."""

    to_stop = False


def raise_if_asked() -> None:
    """End the work here if it shall end.

    Raises:
        KeyboardInterrupt: Somebody asked the command to stop.
    """
    if _Asked.to_stop:
        raise KeyboardInterrupt


@contextmanager
def clean_stop(command: str) -> Iterator[None]:
    """Whoever is asked to end, by Ctrl-C or by the system (SIGTERM), tidies up and says so.

    An interrupt can fall into a place that swallows or renames it (a destructor, the import of a
    module); it is remembered, so that the next stage of the work, or whatever fails first, ends it.
    It can also come while a library computes and Python waits for it, or while a pool waits for its
    workers. Then the process is ended from another thread.

    Args:
        command: Whose word is said if the process has to be ended so.

    Raises:
        KeyboardInterrupt: However the interrupt came out of the block.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        _Asked.to_stop = True
        raise KeyboardInterrupt

    _Asked.to_stop = False
    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        with _watched(command):
            yield
    except Exception as error:
        if not _Asked.to_stop:
            raise
        raise KeyboardInterrupt from error
    finally:
        for number, handler in before.items():
            if handler is not None:  # else something that is not Python had set it
                signal.signal(number, handler)


@contextmanager
def _watched(command: str) -> Iterator[None]:
    """A thread that hears of a signal at once; Python itself does so between two of its steps."""
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    over = threading.Event()

    def watch() -> None:
        heard = ours.recv(1)
        if heard in {bytes([signal.SIGINT]), bytes([signal.SIGTERM])} and not over.wait(PATIENCE):
            _leave(command)

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    earlier = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    try:
        yield
    finally:
        over.set()
        signal.set_wakeup_fd(earlier)
        theirs.close()  # ends the watch
        watcher.join()
        ours.close()


def _leave(command: str) -> None:
    """Remove what is half done and end, whatever the other threads do."""
    from matstd.folder import WORKING

    for folder in tuple(WORKING):
        shutil.rmtree(folder, ignore_errors=True)
    print(stopped_words(command), file=sys.stderr, flush=True)
    os._exit(STOPPED)


def stopped_words(command: str) -> str:
    """What is said of a command that was asked to stop."""
    return f"matstd {command}: stopped, and nothing half-written is left"
