"""Ends a command when it is asked to, tidily and within a second."""

import os
import shutil
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import NoReturn

EXIT_STOPPED = 130  # exit code of a command that was asked to stop

_LAST_WORDS = threading.Lock()

PATIENCE = 0.4
"""Seconds that the command has to come to an end by itself: with what follows, less than one."""


class _Asked:
    """Whether the command was asked to stop."""

    to_stop = False


def raise_if_asked() -> None:
    """Raise KeyboardInterrupt here if the command was asked to stop."""
    if _Asked.to_stop:
        raise KeyboardInterrupt


@contextmanager
def clean_stop() -> Iterator[None]:
    """A command that is asked to end, by Ctrl-C or by the system (SIGTERM), tidies up and says so.

    An interrupt can fall into a place that swallows or renames it (a destructor, the import of a
    module); it is remembered, so that the next stage of the work, or the first failure, ends it. It
    can also come while a library computes and Python waits for it, or while a pool waits for its
    workers; then another thread ends the process. A second request does not disturb the tidying.

    Raises:
        KeyboardInterrupt: In whatever form the interrupt left the block.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        if not _Asked.to_stop:
            _Asked.to_stop = True
            raise KeyboardInterrupt

    _Asked.to_stop = False
    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        with _watched():
            yield
    except BaseException as error:  # some libraries end an import with one that is no Exception
        if not _Asked.to_stop:
            raise
        raise KeyboardInterrupt from error
    finally:
        for number, handler in before.items():
            if handler is not None:  # else something that is not Python had set it
                signal.signal(number, handler)


@contextmanager
def _watched() -> Iterator[None]:
    """A thread that receives a signal at once; Python does so between two of its steps."""
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    over = threading.Event()

    def watch() -> None:
        heard = ours.recv(1)
        if heard in {bytes([signal.SIGINT]), bytes([signal.SIGTERM])} and not over.wait(PATIENCE):
            leave()

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


def leave() -> NoReturn:
    """Remove what is half done, say so and end, whatever the other threads do.

    Python would first take down everything it holds, which takes longer than all the rest.
    """
    _LAST_WORDS.acquire()  # never given back: of two threads that leave, one speaks
    # no import, which could wait for the one that was interrupted
    for folder in _begun("matstd.twin.files.folder", "WORKING"):
        shutil.rmtree(folder, ignore_errors=True)
    for file in _begun("matstd.twin.files.whole", "UNFINISHED"):
        file.unlink(missing_ok=True)
    command = next((f" {word}" for word in sys.argv[1:] if not word.startswith("-")), "")
    cursor = "\x1b[?25h" if sys.stderr.isatty() else ""  # bars of progress hide it
    text = f"{cursor}matstd{command}: stopped, and nothing half-written is left"
    print(text, file=sys.stderr, flush=True)
    os._exit(EXIT_STOPPED)


def _begun(module: str, name: str) -> tuple[Path, ...]:
    """What a module has begun; nothing if it was never imported."""
    return tuple(getattr(sys.modules.get(module), name, ()))
