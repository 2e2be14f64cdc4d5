"""The service by hand and over OPC UA: what reaches the control is right, limited, never a jump."""

import asyncio
import contextlib
import gc
import socket
import sys

import numpy as np
import pytest
from bench import LENGTH

from matstd.compensation.field import MachineErrors, State, correction
from matstd.compensation.service import NAMESPACE, OutputLimits, Service, prompt, serve
from matstd.compensation.service.output import Output, Quality
from matstd.compensation.service.tabulated import MAX_MOMENTS, History
from matstd.twin.errors import BadValue, DesignError
from matstd.twin.library import parse_effect
from matstd.twin.thermal import ThermalLag
from matstd.twin.units import DEG, MINUTE, NM, UM

LIMITS = OutputLimits(most=100.0 * UM, rate=1.0, patience=0.5, hold=5.0)


@pytest.fixture
def service(known, datum):
    return Service(known, LENGTH, datum, LIMITS)


def shown(chain, q):
    """Readings as a control shows them, mm and degrees."""
    units = [DEG if chain.link(a).kind == "rotary" else 1.0 for a in chain.axes]
    return (np.asarray(q) / units).tolist()


def played(output, wanted, seconds, begin=0.0, period=0.005):
    """What comes out while one correction is wanted all the time."""
    sent = []
    for k in range(round(seconds / period)):
        if wanted is not None:
            output.want(wanted, begin + k * period)
        sent.append(output.step(begin + k * period))
    return sent


def test_a_step_settles_within_25_ms_and_never_jumps():
    sent = played(Output(LIMITS), (20.0 * UM, -20.0 * UM, 0.0), 0.030)
    values = np.array([s.values for s in sent])
    assert np.abs(np.diff(values, axis=0)).max() <= 1.0 * 0.005 + 1e-12
    assert not values[0].any()
    np.testing.assert_allclose(values[5], [20.0 * UM, -20.0 * UM, 0.0])
    assert sent[-1].quality is Quality.VALID
    assert sent[-1].lag == pytest.approx(0.0, abs=1e-12)


def test_more_than_the_limit_is_cut_and_said():
    sent = played(Output(LIMITS), (0.0, 0.0, 150.0 * UM), 0.5)[-1]
    assert sent.values[2] == pytest.approx(100.0 * UM)
    assert sent.quality is Quality.LIMITED


def test_a_cut_link_holds_then_fades_without_a_jump():
    output = Output(LIMITS)
    played(output, (50.0 * UM, 0.0, 0.0), 0.5)
    silent = played(output, None, 6.0, begin=0.5)
    names = [s.quality for s in silent]
    assert names[0] is Quality.VALID
    assert names[round(2.0 / 0.005)] is Quality.HELD
    assert silent[round(4.4 / 0.005)].values[0] == pytest.approx(50.0 * UM)
    assert names[-1] is Quality.FADING
    assert silent[-1].values == (0.0, 0.0, 0.0)
    moved = np.abs(np.diff([s.values[0] for s in silent]))
    assert moved.max() <= 0.005 + 1e-12
    back = played(output, (50.0 * UM, 0.0, 0.0), 0.1, begin=100.0)  # switched on again, later
    assert back[0].values[0] <= LIMITS.rate * 0.05
    assert back[-1].values[0] == pytest.approx(50.0 * UM)


@pytest.mark.parametrize(
    ("given", "said"),
    [({"rate": 0.0}, "rate"), ({"most": float("nan")}, "most"), ({"hold": 0.1}, "the patience")],
)
def test_limits_that_make_no_sense_are_refused(given, said):
    with pytest.raises(BadValue, match=said):
        OutputLimits(**given)


def test_requests_are_answered_by_the_inverse(known, datum, poses, bench_chain):
    service = Service(known, LENGTH, datum, OutputLimits(most=1.0))
    aim = datum.deviation(known)
    columns = [bench_chain.axis_index(a) for a in service.correction.linear_axes]
    for k, q in enumerate(poses[:10]):
        service.move(k + 1, shown(bench_chain, q), now=float(k))
        answer = service.tick(float(k))
        exact = correction(known, known.touches(q[None], LENGTH), aim)[0, columns]
        assert answer.sequence == k + 1
        np.testing.assert_allclose(answer.k0, exact, atol=20 * NM)
        beside = q.copy()
        beside[columns[0]] -= 0.5 * np.sign(q[columns[0]])
        moved = correction(known, known.touches(beside[None], LENGTH), aim)[0, columns]
        line = answer.k0[0] + answer.k1[0] * (beside[columns[0]] - answer.p0[0])
        assert line == pytest.approx(moved[0], abs=30 * NM)


@pytest.mark.parametrize("share", [0.3, 1.5, 10.0])
def test_the_line_between_two_answers_is_limited_over_the_whole_travel(
    known, datum, poses, bench_chain, share
):
    """A control that goes on with K0 and K1 is asked for no more than --most either."""
    free = Service(known, LENGTH, datum, OutputLimits(most=1.0))
    wanted = []
    for k, q in enumerate(poses[:10]):
        free.move(k + 1, shown(bench_chain, q), now=float(k))
        wanted.append(free.tick(float(k)))
    most = share * float(np.abs([answer.k0 for answer in wanted]).max())
    limited = Service(known, LENGTH, datum, OutputLimits(most=most))
    ends = np.array([bench_chain.link(a).range for a in limited.correction.linear_axes])
    cut = 0
    for k, (q, free_answer) in enumerate(zip(poses[:10], wanted, strict=True)):
        limited.move(k + 1, shown(bench_chain, q), now=float(k))
        answer = limited.tick(float(k))
        k0, k1, p0 = (np.array(v)[:, None] for v in (answer.k0, answer.k1, answer.p0))
        assert np.abs(k0 + k1 * (ends - p0)).max() <= most * (1.0 + 1e-12)
        k0, k1 = np.array(free_answer.k0), np.array(free_answer.k1)
        np.testing.assert_allclose(answer.k0, np.clip(k0, -most, most), atol=1e-15)
        there = np.abs(k0[:, None] + k1[:, None] * (ends - np.array(free_answer.p0)[:, None]))
        is_within = (there.max(axis=1) <= most) & (np.abs(k0) < most)
        np.testing.assert_array_equal(np.array(answer.k1)[is_within], k1[is_within])
        cut += int((~is_within).sum())
    assert (cut > 0) == (share < 10.0)


def test_the_line_fades_with_the_correction(service, bench_chain, poses):
    service.move(1, shown(bench_chain, poses[0]), now=0.0)
    assert any(service.tick(0.0).k0)
    for now in np.arange(0.05, LIMITS.hold + 1.0, 0.05).tolist():
        answer = service.tick(now)
    assert answer.sent.quality is Quality.FADING
    assert answer.k0 == answer.sent.values == (0.0, 0.0, 0.0)
    assert answer.k1 == (0.0, 0.0, 0.0)


def test_readings_that_are_not_understood_are_no_readings(service, bench_chain, poses):
    service.move(1, shown(bench_chain, poses[0]), now=0.0)
    held = service.tick(0.0).k0
    for number, (readings, said) in enumerate(
        [([0.0, 0.0], "2 readings, expected 6"), ([1e4] * 6, "beyond its travel")], start=2
    ):
        service.move(number, readings, now=1.0)
        answer = service.tick(1.0)
        assert said in answer.refused
        assert answer.k0 == held
        assert answer.sent.quality is Quality.HELD
    service.move(4, shown(bench_chain, poses[1]), now=1.1)
    assert service.tick(1.1).refused == ""


def test_a_warming_machine_is_followed_as_its_lag_says(bench_chain, datum):
    """By hand: after a step of 10 K a body of 5 min has gone 10 (1 - exp(-t / 5 min)) K."""
    lag = ThermalLag(parse_effect("thermal-lag(EZZ,frame)", bench_chain).symbol, "frame", 300.0)
    begin = State(temperature={"frame": 20.0})
    errors = MachineErrors.of_errors(bench_chain, [(lag, np.array([2.0 * UM]))], begin)
    service = Service(errors, LENGTH, datum, OutputLimits(most=1.0))
    service.drive(1.0, {"frame": 30.0})
    for k in range(1, 121):
        service.drive(1.0 + 5.0 * k, {"frame": 30.0})
    service.move(1, shown(bench_chain, datum.q), now=0.0)
    z = service.tick(0.0).k0[service.correction.linear_axes.index("Z")]
    warmth = 10.0 * (1.0 - np.exp(-10.0 * MINUTE / 300.0))
    assert z == pytest.approx(-2.0 * UM * warmth, rel=0.01)


def test_what_drives_the_machine_is_a_number(bench_chain, datum):
    """A gateway that has lost a value hands NaN over: the tables stay as they were."""
    growth = parse_effect("thermal-lag(EZZ,spindle_rpm)", bench_chain)
    begin = State(temperature={"frame": 20.0}, spindle_rpm=1000.0)
    theta = np.full(len(growth.parameters), 10.0 * UM)
    errors = MachineErrors.of_errors(bench_chain, [(growth, theta)], begin)
    service = Service(errors, LENGTH, datum, OutputLimits(most=1.0))
    before = service.correction.at(datum.q.tolist())
    for warm, speed, said in (
        (np.nan, 1000.0, "temperature frame: nan, expected a number"),
        (20.0, np.nan, "spindle speed: nan, expected a number"),
        (20.0, np.inf, "spindle speed: inf, expected a number"),
    ):
        with pytest.raises(DesignError, match=said):
            service.drive(1.0, {"frame": warm}, speed)
    assert service.correction.at(datum.q.tolist()) == before


def test_a_history_goes_forward_with_its_sensors():
    history = History((State(temperature={"a": 20.0}),))
    with pytest.raises(DesignError, match="expected later than 0 s"):
        history.then(State(temperature={"a": 21.0}))
    with pytest.raises(DesignError, match="sensors none, expected a"):
        history.then(State(time=1.0))
    for k in range(1, MAX_MOMENTS + 10):
        history = history.then(State(time=float(k), temperature={"a": 20.0}))
    assert len(history) <= MAX_MOMENTS
    assert history.now.time == MAX_MOMENTS + 9
    assert history.states[0].time == 0.0


@pytest.mark.parametrize("url", ["nonsense", "http://localhost:80", "opc.tcp://h", "opc.tcp://h:x"])
def test_an_endpoint_that_is_no_address_is_refused(service, url):
    pytest.importorskip("asyncua")
    with pytest.raises(BadValue, match="endpoint"):
        asyncio.run(serve(service, url))


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def test_no_request_over_opc_ua_is_lost_or_repeated(service, bench_chain, poses):
    """A client as a control would be: 40 requests, the link cut, a port that is taken."""
    asyncua = pytest.importorskip("asyncua")
    url = f"opc.tcp://127.0.0.1:{free_port()}"

    async def client():
        async with asyncua.Client(url) as control:
            space = await control.get_namespace_index(NAMESPACE)
            find = control.nodes.objects.get_child
            names = ("Readings", "Sequence", "Answered", "K0", "Quality", "Refused", "Uncertainty")
            nodes = {n: await find([f"{space}:Compensation", f"{space}:{n}"]) for n in names}
            answers = []
            for number in range(1, 41):
                readings = shown(bench_chain, poses[number % len(poses)])
                await control.write_values(
                    [nodes["Readings"], nodes["Sequence"]], [readings, number]
                )
                while await nodes["Answered"].read_value() != number:
                    await asyncio.sleep(0.002)
                answers.append(await nodes["K0"].read_value())
            await asyncio.sleep(0.8)
            quality = await nodes["Quality"].read_value()
            with pytest.raises(DesignError, match=r"opc\.tcp"):
                await serve(service, url)
            return answers, quality, await nodes["Uncertainty"].read_value()

    async def both():
        ready, until = asyncio.Event(), asyncio.Event()
        server = asyncio.create_task(serve(service, url, ready.set, until))
        await asyncio.wait_for(ready.wait(), 30.0)
        try:
            return await client()
        finally:
            until.set()
            with contextlib.suppress(asyncio.CancelledError):
                await server

    answers, quality, u = asyncio.run(asyncio.wait_for(both(), 60.0))
    expected = [service.correction.at(poses[n % len(poses)].tolist()) for n in range(1, 41)]
    assert np.abs(expected).max() > LIMITS.most
    np.testing.assert_allclose(answers, np.clip(expected, -LIMITS.most, LIMITS.most), atol=1e-12)
    assert quality == "held"
    assert u == [0.0, 0.0, 0.0]  # errors that are known without uncertainty


def test_a_prompt_process_switches_threads_every_half_millisecond() -> None:
    before = sys.getswitchinterval()
    with prompt():
        assert sys.getswitchinterval() == pytest.approx(0.5e-3)
        assert gc.get_freeze_count() > 0
    assert sys.getswitchinterval() == before
    assert gc.get_freeze_count() == 0
