"""Cost and reactions of the operator's page beside a live session without a window: real processes, real sockets."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from itertools import count
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.play.operators_page import check_console
from mimics_app.console.meeting_place import MeetingPlace, PageAddress
from mimics_app.console.telemetry import TELEMETRY, VALUES
from mimics_app.contracts.clock import SECOND_NS, Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.recording.run import Run
from mimics_app.recording.series import series_of

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

__all__ = ["measure_console"]

_CLIENTS = 3
_SECONDS = 12.0
"""Length of each session that is compared [s]."""
_WATCHED_S = 5.0
_START_S = 120.0
_SOCKETS = 1000
_STATE, _FORCE = VALUES.index("state"), VALUES.index("force")
_NO_FORCE = 1e-9
_LATCHED = (SafetyState.E_STOP, SafetyState.SAFE_STOP)
_ASK_EVERY = 30
"""Messages from one request to leave a stop to the next."""
_TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100
_CLOCK: Clock = MonotonicClock()


def measure_console(scene: Path, stops: int, rounds: int, say: Callable[[str], None]) -> dict[str, Any]:
    """Return the figures of `mimics bench console`.

    Args:
        scene: Scene of the sessions.
        stops: Number of times STOP is pressed, half of them, rounded up, while attackers hold both servers.
        rounds: Number of pairs of sessions with and without clients; the median of their ratios is shown.
        say: Shows progress.
    """
    check_console()
    with tempfile.TemporaryDirectory(prefix="mimics-bench-") as folder, _meeting_in(folder):
        say("sessions with and without clients")
        ratios = [_lateness(scene, folder, _CLIENTS) / _lateness(scene, folder, 0) for _ in range(rounds)]
        with _page():
            with _session(scene, folder, None):
                page = _served()
                say("rate of the page and cost of its server")
                rate, share = _watch(page)
                say(f"{stops} presses of STOP")
                free = _press_many(page, (stops + 1) // 2)
                with _attackers(page):
                    attacked = _press_many(page, (stops + 1) // 2)
                tried, refused = _attacks(page)
            stopped_ns = _stopped_ns(max(Path(folder).glob("*_*"), key=lambda run: run.stat().st_mtime_ns))
    return {
        "stop_ms": _spread(_until_stopped_ms(free, stopped_ns)),
        "stop_attacked_ms": _spread(_until_stopped_ms(attacked, stopped_ns)),
        "stop_shown_ms": _spread([press.shown_ms for press in free]),
        "stop_shown_attacked_ms": _spread([press.shown_ms for press in attacked]),
        "page_hz": rate,
        "server_cpu": share,
        "haptic_p99_ratio": float(np.median(ratios)),
        "attacks": {"tried": tried, "refused": refused},
    }


def _spread(times_ms: Sequence[float]) -> dict[str, float]:
    return {"p50": float(np.percentile(times_ms, 50)), "p99": float(np.percentile(times_ms, 99))}


@contextmanager
def _meeting_in(folder: str) -> Iterator[None]:
    """Let page and sessions meet in a folder of their own."""
    before = os.environ.get("XDG_RUNTIME_DIR")
    os.environ["XDG_RUNTIME_DIR"] = folder
    try:
        yield
    finally:
        os.environ.pop("XDG_RUNTIME_DIR")
        if before is not None:
            os.environ["XDG_RUNTIME_DIR"] = before


def _words(*words: object) -> list[str]:
    return [sys.executable, "-m", "mimics_app", *map(str, words)]


@contextmanager
def _page() -> Iterator[None]:
    page = subprocess.Popen(_words("console", "--port", 0), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        _served()
        yield
    finally:
        page.terminate()
        page.wait()


def _served() -> PageAddress:
    deadline = _CLOCK.now_ns() + int(_START_S * SECOND_NS)
    while (address := MeetingPlace().served()) is None:
        if _CLOCK.now_ns() > deadline:
            raise DeviceError("the operator's page does not start", "try mimics console")
        _wait(0.05)
    return address


def _wait(seconds: float) -> None:
    _CLOCK.sleep_until_ns(_CLOCK.now_ns() + int(seconds * SECOND_NS))


@contextmanager
def _session(scene: Path, runs: str, seconds: float | None) -> Iterator[subprocess.Popen[str]]:
    """A live session without a window; it is ended where it has no length."""
    length = [] if seconds is None else ["--seconds", seconds]
    words = _words("run", scene, "--headless", "--console", 0, "--operator-lost", "continue", "--pictures", 0)
    words += _words("--sound", "off", "--runs", runs, "--trials", 1000, "--json", *length)[3:]
    run = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield run
    finally:
        if run.poll() is None:
            run.terminate()
        run.wait()


def _lateness(scene: Path, runs: str, clients: int) -> float:
    """Return the p99 lateness of a session beside a number of clients [us]."""
    with _page(), _session(scene, runs, _SECONDS) as run, ExitStack() as stack:
        page, over = _served(), Event()
        for _ in range(clients):
            connection = stack.enter_context(_connect(page))
            Thread(target=_read_on, args=(connection, over), daemon=True).start()
        out, _ = run.communicate()
        over.set()
    return float(json.loads(out)["lateness_us"]["p99"])


def _read_on(connection: ClientConnection, over: Event) -> None:
    with suppress(Exception):
        while not over.is_set():
            connection.recv()


# a client


def _post(url: str, body: bytes, headers: dict[str, str]) -> tuple[int, str]:
    """Return status and cookie of a POST."""
    try:
        with urllib.request.urlopen(urllib.request.Request(url, body, headers), timeout=20) as answer:
            return int(answer.status), str(answer.headers.get("set-cookie", "")).partition(";")[0]
    except urllib.error.HTTPError as error:
        with error:
            return error.code, ""


def _enter(page: PageAddress) -> dict[str, str]:
    """Return the headers of a page that has entered."""
    origin, _, token = page.url.partition("/#")
    _, cookie = _post(f"{origin}/enter", json.dumps({"token": token}).encode(), {"origin": origin})
    return {"origin": origin, "cookie": cookie}


def _connect(page: PageAddress, **changes: str) -> ClientConnection:
    from websockets.sync.client import connect
    from websockets.typing import Origin

    headers = _enter(page) | changes
    address = page.url.partition("/#")[0].replace("http", "ws", 1) + "/live"
    origin = Origin(headers["origin"]) if headers["origin"] else None
    return connect(
        address, origin=origin, additional_headers={"Cookie": headers["cookie"]}, max_queue=None, open_timeout=30
    )


def _values(message: str | bytes) -> list[float] | None:
    """Return the numbers of a message of telemetry; None for others."""
    if isinstance(message, str) or len(message) <= 8 or int.from_bytes(message[:4], "little") != TELEMETRY:
        return None
    return np.frombuffer(message, "<f8", offset=8).tolist()


def _watch(page: PageAddress) -> tuple[float, float]:
    """Return the rate of telemetry of one client [Hz], and the share of a core that both servers take."""
    with _connect(page) as client:
        while _values(client.recv(timeout=_START_S)) is None:
            pass
        begun, cpu, received = _CLOCK.now_ns(), _cpu_s(page), 0
        while _CLOCK.now_ns() - begun < _WATCHED_S * SECOND_NS:
            received += _values(client.recv(timeout=10)) is not None
        seconds = (_CLOCK.now_ns() - begun) / SECOND_NS
        return received / seconds, (_cpu_s(page) - cpu) / seconds


def _cpu_s(page: PageAddress) -> float:
    """Return the processor time of both servers [s]; on Linux."""
    children = Path(f"/proc/{page.pid}/task/{page.pid}/children")
    pids = [page.pid, *(int(pid) for pid in children.read_text().split())] if children.exists() else []
    ticks = 0
    for pid in pids:
        with suppress(OSError):
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            ticks += int(fields[11]) + int(fields[12])
    return ticks / _TICKS_PER_SECOND


class _Press(NamedTuple):
    """A press of STOP: when it was [ns], and after what time the page had its first number without force [ms]."""

    at_ns: int
    shown_ms: float


def _stopped_ns(run: Path) -> NDArray[np.int64]:
    """Return when the ticks of a recording were done in which a stop had taken the force away [ns]."""
    recorded = Run.open(run)
    (haptic,) = (each for each in series_of(recorded) if each.name == "haptic")
    names = haptic.columns
    forces = [names.index(f"f_user_world[{i}]") for i in range(3)]
    found = []
    for batch in haptic.batches():
        still = np.linalg.norm(batch.values[:, forces], axis=1) < _NO_FORCE
        stopped = still & (batch.values[:, names.index("state")] == SafetyState.E_STOP)
        late_ns = batch.values[:, names.index("lateness_ns")] + batch.values[:, names.index("duration_ns")]
        found.append((recorded.start_ns + SECOND_NS * batch.t_s + late_ns)[stopped])
    return np.concatenate(found).astype(np.int64)


def _until_stopped_ms(presses: Sequence[_Press], stopped_ns: NDArray[np.int64]) -> list[float]:
    """Return the time from each press to the end of the first tick without force [ms]."""
    firsts = np.searchsorted(stopped_ns, [press.at_ns for press in presses])
    return [(int(stopped_ns[first]) - press.at_ns) / 1e6 for press, first in zip(presses, firsts, strict=True)]


def _press_many(page: PageAddress, presses: int) -> list[_Press]:
    """Press STOP a number of times, each after force was allowed again."""
    headers, times, numbers = _enter(page), list[_Press](), count(1)
    with _connect(page) as client:
        for _ in range(presses):
            _allow_force(client, numbers)
            begun = _CLOCK.now_ns()
            _post(f"{page.stop_url}/stop", json.dumps({"nonce": str(uuid.uuid4())}).encode(), headers)
            _until(client, lambda values: values[_STATE] == SafetyState.E_STOP and values[_FORCE] < _NO_FORCE)
            times.append(_Press(begun, (_CLOCK.now_ns() - begun) / 1e6))
    return times


def _allow_force(client: ClientConnection, numbers: Iterator[int]) -> None:
    """Reset the stop; the session refuses that until its frame has seen the stop, so it is asked again."""
    for message in count():
        values = _values(client.recv(timeout=_START_S))
        if values is not None and values[_STATE] not in _LATCHED:
            return
        if message % _ASK_EVERY == 0:
            client.send(json.dumps({"id": next(numbers), "command": {"command": "reset"}}))


def _until(client: ClientConnection, reached: Callable[[list[float]], bool]) -> None:
    while True:
        values = _values(client.recv(timeout=_START_S))
        if values is not None and reached(values):
            return


# attackers


@contextmanager
def _attackers(page: PageAddress) -> Iterator[None]:
    """Hold both servers with a thousand sockets, most of them with a request that never ends."""
    ports = [int(url.rpartition(":")[2]) for url in (page.url.partition("/#")[0], page.stop_url)]
    with ExitStack() as stack:
        for number in range(_SOCKETS):
            attacker = stack.enter_context(socket.create_connection(("127.0.0.1", ports[number % 2]), timeout=30))
            if number % 3:
                attacker.send(b"POST /stop HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
        yield


def _attacks(page: PageAddress) -> tuple[int, int]:
    """Return how many attacks were tried, and how many were refused; the sockets and slow requests count as two."""
    headers, url = _enter(page), f"{page.stop_url}/stop"
    body = json.dumps({"nonce": "benched"}).encode()
    _post(url, body, headers)
    refused = [
        _post(url, body, headers)[0] == 409,
        _post(url, body, headers | {"host": "evil.example"})[0] == 400,
        _post(url, body, {"cookie": headers["cookie"]})[0] == 403,
        _post(url, b" " * 100_000, headers)[0] == 400,
        _post(page.url.partition("/#")[0] + "/enter", b'{"token": "wrong"}', headers)[0] == 403,
        _is_refused(page, cookie=""),
        _is_refused(page, origin="http://evil.example"),
        _get(url) == 405,
    ]
    with _attackers(page):
        stopped = _post(url, json.dumps({"nonce": str(uuid.uuid4())}).encode(), headers)[0] == 200
    return len(refused) + 2, sum(refused) + 2 * stopped


def _is_refused(page: PageAddress, **changes: str) -> bool:
    from websockets.exceptions import InvalidStatus

    try:
        _connect(page, **changes).close()
    except InvalidStatus as refusal:
        return refusal.response.status_code == 403
    return False


def _get(url: str) -> int:
    try:
        with urllib.request.urlopen(url, timeout=20) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        with error:
            return error.code
