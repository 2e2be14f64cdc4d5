"""The service as an OPC UA server: a control, or a gateway, writes and reads nodes."""

from __future__ import annotations

import asyncio
import gc
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from socket import create_server
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from matstd.compensation.service.service import DRIVEN_EVERY, Answer, Service
from matstd.twin.errors import BadValue, DesignError, MissingLibrary, OutsideTravel

if TYPE_CHECKING:
    from asyncua.common.node import Node
    from asyncua.server.server import Server

SWITCH_INTERVAL = 0.0005
"""After which a thread that works out tables or uncertainties gives way, s; Python's own 5 ms would
be waited for at every answer."""


@contextmanager
def prompt() -> Iterator[None]:
    """Yield quickly, and keep present objects out of garbage collection.

    The address space of an OPC UA server alone has some 100 000 objects, which a full collection
    looks through for tens of milliseconds.
    """
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL)
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
        sys.setswitchinterval(before)


NAMESPACE = "urn:material-standard:compensation"
"""Namespace of the nodes."""

OUTPUT_PERIOD = 0.005  # time between two outputs without a request, s
SWITCH_INTERVAL_MOVING = 0.002  # the same while a correction is moving
_KNOWN_EVERY = 1.0  # s, uncertainty: it changes slowly and takes longer than a correction


async def serve(
    service: Service,
    endpoint: str,
    ready: Callable[[], None] = lambda: None,
    until: asyncio.Event | None = None,
) -> None:
    """Answer until the event is set, or for ever.

    Args:
        endpoint: Such as `opc.tcp://localhost:4840`.

    Raises:
        MissingLibrary: asyncua is not installed.
        BadValue: An endpoint that is no address.
        DesignError: The endpoint cannot be opened.
    """
    try:
        from asyncua.common.callback import CallbackType
        from asyncua.server.server import Server
    except ImportError as error:
        raise MissingLibrary(
            "the service needs asyncua: pip install material-standard[service]"
        ) from error
    _check(endpoint)
    server, until = Server(), until or asyncio.Event()
    await server.init()
    server.set_endpoint(endpoint)
    server.set_server_name(f"Compensation of {service.errors.chain.name}")
    nodes = await _Nodes.add(server, service)
    written = asyncio.Event()
    server.subscribe_server_callback(
        CallbackType.PostWrite, lambda done, _: written.set() if done.is_external else None
    )
    try:
        await server.start()
    except OSError as error:
        raise DesignError(f"{endpoint}: {error.strerror or error}") from error
    try:
        with prompt():
            ready()
            slow = asyncio.create_task(_follow(service, nodes, until))
            while not until.is_set():
                written.clear()
                lag = await nodes.exchange(service)
                with suppress(TimeoutError):
                    await asyncio.wait_for(
                        written.wait(), SWITCH_INTERVAL_MOVING if lag else OUTPUT_PERIOD
                    )
            await slow
    finally:
        await server.stop()


def _check(endpoint: str) -> None:
    try:
        parts = urlsplit(endpoint)
        good = parts.scheme == "opc.tcp" and parts.hostname and parts.port
    except ValueError:  # a port that is no number
        good = False
    if not good:
        raise BadValue("endpoint", repr(endpoint), "an address such as opc.tcp://localhost:4840")
    try:  # before the server is built, which takes seconds
        with closing(create_server((parts.hostname, parts.port))):
            return
    except OSError as error:
        raise DesignError(f"{endpoint}: {error.strerror or error}") from error


async def _follow(service: Service, nodes: _Nodes, until: asyncio.Event) -> None:
    """Temperatures, probings and uncertainty, beside the fast loop."""
    begun = time.monotonic()
    driven = begun
    while not until.is_set():
        await asyncio.sleep(0.2)
        now = time.monotonic()
        if now - driven >= DRIVEN_EVERY:
            driven = now
            await nodes.drive(service, service.errors.state.time + now - begun)
            await nodes.write_drift(service)
        await nodes.learn(service)
        if now - nodes.known_at >= _KNOWN_EVERY:
            nodes.known_at = now
            await nodes.write_uncertainty(service)


class _Nodes:
    """Inputs and outputs of a server."""

    def __init__(self, inputs: dict[str, Node], outputs: dict[str, Node]) -> None:
        self.inputs, self.outputs = inputs, outputs
        self.known_at, self._answered, self._undriven = 0.0, 0, ""
        self._shown: dict[str, Any] = {}
        self._probed, self._unlearnt = 0, ""

    @classmethod
    async def add(cls, server: Server, service: Service) -> _Nodes:
        """Nodes below one object, by name."""
        from asyncua import ua

        space = await server.register_namespace(NAMESPACE)
        parent = await server.nodes.objects.add_object(space, "Compensation")
        chain, state, three = service.errors.chain, service.errors.state, [0.0, 0.0, 0.0]
        double, whole, text = ua.VariantType.Double, ua.VariantType.Int64, ua.VariantType.String
        given = {
            "Readings": ([0.0] * len(chain.axes), double),
            "Directions": ([0] * len(chain.axes), whole),
            "Temperatures": (list(state.temperature.values()), double),
            "SpindleSpeed": (state.spindle_rpm or 0.0, double),
            "Sequence": (0, whole),
            "Probed": ([0.0] * len(service.drifts.columns), double),
            "ProbedUncertainty": ([0.0] * len(service.drifts.columns), double),
            "ProbedSequence": (0, whole),
        }
        written = {
            "Axes": (list(chain.axes), text),
            "LinearAxes": (list(service.correction.linear_axes), text),
            "Sensors": (list(service.sensors), text),
            "Answered": (0, whole),
            "Correction": (three, double),
            "K0": (three, double),
            "K1": (three, double),
            "P0": (three, double),
            "Uncertainty": (three, double),
            "Quality": ("", text),
            "Age": (0.0, double),
            "Lag": (0.0, double),
            "Refused": ("", text),
            "DriftColumns": (list(service.drifts.columns), text),
            "Drift": (service.drifts.drift, double),
            "DriftUncertainty": (service.drifts.u, double),
            "ProbedAnswered": (0, whole),
        }
        inputs = {k: await parent.add_variable(space, k, *v) for k, v in given.items()}
        outputs = {k: await parent.add_variable(space, k, *v) for k, v in written.items()}
        for node in inputs.values():
            await node.set_writable()
        return cls(inputs, outputs)

    async def exchange(self, service: Service) -> float:
        """A new request, if there is one, and what is answered now; the way still to go, mm."""
        sequence = await self.inputs["Sequence"].read_value()
        if sequence != self._answered:
            readings = await self.inputs["Readings"].read_value()
            directions = await self.inputs["Directions"].read_value()
            service.move(sequence, readings or [], time.monotonic(), directions or [])
            self._answered = sequence
        answer = service.tick(time.monotonic())
        await self._show(answer)
        return answer.sent.lag

    async def _show(self, answer: Answer) -> None:
        sent = answer.sent
        values = {
            "Correction": list(sent.values),
            "K0": list(answer.k0),
            "K1": list(answer.k1),
            "P0": list(answer.p0),
            "Quality": str(sent.quality),
            "Age": round(min(sent.age, 1e9), 2),
            "Lag": sent.lag,
            "Refused": "; ".join(filter(None, (answer.refused, self._undriven, self._unlearnt))),
            "Answered": answer.sequence,  # last: who sees it finds the others
        }
        for name, value in values.items():
            if self._shown.get(name) != value:
                self._shown[name] = value
                await self.outputs[name].write_value(value)

    async def drive(self, service: Service, now: float) -> None:
        """Temperatures and speed; what is no number leaves the tables as they are."""
        warm = await self.inputs["Temperatures"].read_value() or []
        speed = await self.inputs["SpindleSpeed"].read_value()
        known = service.errors.state.spindle_rpm is not None
        temperature = dict(zip(service.sensors, warm, strict=False))
        try:
            await asyncio.to_thread(service.drive, now, temperature, speed if known else None)
            self._undriven = ""
        except DesignError as error:
            self._undriven = str(error)

    async def learn(self, service: Service) -> None:
        """What was probed, if it is new; what is not understood changes nothing."""
        sequence = await self.inputs["ProbedSequence"].read_value()
        if sequence == self._probed:
            return
        left = await self.inputs["Probed"].read_value() or []
        u = await self.inputs["ProbedUncertainty"].read_value() or []
        try:
            await asyncio.to_thread(service.probed, left, u)
            self._unlearnt = ""
        except DesignError as error:
            self._unlearnt = str(error)
        self._probed = sequence
        await self.outputs["ProbedAnswered"].write_value(sequence)

    async def write_drift(self, service: Service) -> None:
        """Write the drift of the columns of saved laws since the preset."""
        if service.drifts.columns:
            await self.outputs["Drift"].write_value(service.drifts.drift)
            await self.outputs["DriftUncertainty"].write_value(service.drifts.u)

    async def write_uncertainty(self, service: Service) -> None:
        """Write the uncertainty at the last readings."""
        readings = await self.inputs["Readings"].read_value() or []
        try:
            u = await asyncio.to_thread(service.uncertainty, readings)
        except OutsideTravel:
            return
        await self.outputs["Uncertainty"].write_value(list(u))
