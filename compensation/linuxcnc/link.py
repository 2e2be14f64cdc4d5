"""The service on a socket of this computer, where the component of LinuxCNC asks it."""

import asyncio
import contextlib
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from matstd.compensation.service import DRIVEN_EVERY, Service, prompt
from matstd.twin.errors import DesignError


async def serve_linuxcnc(
    service: Service,
    path: Path,
    ready: Callable[[], None] = lambda: None,
    until: asyncio.Event | None = None,
) -> None:
    """Answer until the event is set, or for ever.

    Args:
        path: Path of the socket; one without a listener is removed.

    Raises:
        DesignError: Another service answers there, or the socket cannot be made.
    """
    until = until or asyncio.Event()
    await _clear(path)
    asked = _QuestionHandler(service)
    try:
        server = await asyncio.start_unix_server(asked.answer_all, path)
    except OSError as error:
        raise DesignError(f"{path}: {error.strerror or error}") from error
    try:
        with prompt():
            ready()
            await asked.follow(until)
    finally:
        server.close()
        asked.cut()
        path.unlink(missing_ok=True)


async def _clear(path: Path) -> None:
    """Take away the socket of a service that has died; raises DesignError."""
    if not path.exists():
        return
    try:
        _, writer = await asyncio.open_unix_connection(path)
    except ConnectionRefusedError:
        path.unlink()
        return
    except OSError as error:
        raise DesignError(f"{path}: {error.strerror or error}") from error
    writer.close()
    raise DesignError(f"{path}: another service answers there already; end it first")


class _QuestionHandler:
    """Questions of the component."""

    def __init__(self, service: Service) -> None:
        self.service = service
        self.driven: dict[str, Any] = {}
        self.undriven = ""
        self._links: set[asyncio.StreamWriter] = set()

    async def answer_all(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """A line in, a line out, until the component goes."""
        self._links.add(writer)
        with contextlib.suppress(OSError):
            while line := await reader.readline():
                writer.write(self.answer(line).encode())
                await writer.drain()
        self._links.discard(writer)
        writer.close()

    def cut(self) -> None:
        """Close what is open."""
        for writer in self._links:
            writer.close()

    def answer(self, line: bytes) -> str:
        """The correction at the positions of a line; an unreadable line is no question."""
        now, chain = time.monotonic(), self.service.errors.chain
        try:
            question = json.loads(line)
            at, ways = question["readings"], question["directions"]
            readings = [float(at.get(a.lower(), 0.0)) for a in chain.axes]
            directions = [int(ways.get(a.lower(), 0)) for a in chain.axes]
            self.driven, number = question, int(question["number"])
            self.service.move(number, readings, now, directions)
        except (ValueError, KeyError, TypeError, AttributeError):
            number = 0
        answer = self.service.tick(now)
        refused = "; ".join(filter(None, (answer.refused, self.undriven)))
        reply = {"number": number, "correction": answer.sent.values, "refused": refused}
        return json.dumps(reply | {"quality": str(answer.sent.quality)}) + "\n"

    async def follow(self, until: asyncio.Event) -> None:
        """Temperatures and speed every two seconds."""
        begun = time.monotonic()
        while not until.is_set():
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(until.wait(), DRIVEN_EVERY)
            if self.driven and not until.is_set():
                await self._drive(self.service.errors.state.time + time.monotonic() - begun)

    async def _drive(self, now: float) -> None:
        warm = self.driven.get("temperatures", {})
        known = self.service.errors.state.spindle_rpm is not None
        speed = abs(float(self.driven.get("spindle_rpm", 0.0))) if known else None
        temperature = {n: float(warm[n]) for n in self.service.sensors if n in warm}
        try:
            await asyncio.to_thread(self.service.drive, now, temperature, speed)
            self.undriven = ""
        except DesignError as error:
            self.undriven = str(error)
