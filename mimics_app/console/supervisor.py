"""The process that stays: it serves STOP, receives sessions, and restarts the page's server when that dies or hangs."""

from __future__ import annotations

import asyncio
import os
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from typing import IO, TYPE_CHECKING

from mimics_app.console.access import Access, new_tokens
from mimics_app.console.handover import AttachedSession, Lines, attach, send_line
from mimics_app.console.meeting_place import MeetingPlace, PageAddress
from mimics_app.console.page_server import IGNORED, PageSettings, serve_page
from mimics_app.console.stop_server import StopButton, stop_app
from mimics_app.console.web_server import Certificate, WebServer, listen
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system.child_main import main_hidden
from mimics_app.contracts.system.child_signals import signals_blocked

if TYPE_CHECKING:
    from multiprocessing.context import SpawnProcess

__all__ = ["Serving", "Supervisor", "open_supervisor"]

_PERIOD_S = 0.1
_HUNG_S = 15.0
"""Time without a sign of life after which the page's server is replaced: it runs when nobody else does [s]."""
_ALONE_S = 60.0
"""Time without a session after which a page ends that a run has started, once that run is gone [s]."""
_VISITORS = 8

_LEFT = "The session is over."
_GONE = "The application is gone: it crashed or was killed. Its recording can be repaired: mimics record recover."


class _Visit:
    """A session's connection."""

    def __init__(self, line: socket.socket) -> None:
        self.line, self.lines = line, Lines(line)
        self.attached = False
        self.ended_orderly = False


@dataclass(frozen=True, slots=True)
class _Places:
    """Listening sockets: of STOP, of the page, and of sessions."""

    stop: socket.socket
    page: socket.socket
    sessions: socket.socket


class Supervisor:
    """Serves STOP and keeps the page's server running.

    Args:
        settings: What the page's server is given.
        places: Listening sockets.
        starter_lives: Whether the run that started this page still lives; None: a person started it, and ends it.
    """

    def __init__(
        self,
        settings: PageSettings,
        places: _Places,
        starter_lives: Callable[[], bool] | None,
    ) -> None:
        self._settings, self._places = settings, places
        self._starter_lives = starter_lives
        self._button = StopButton()
        self._server = WebServer(stop_app(self._button, settings.access), places.stop, settings.certificate)
        self._visits: list[_Visit] = []
        self._session: AttachedSession | None = None
        self._page: SpawnProcess | None = None
        self._line: socket.socket | None = None
        self._beats: Lines | None = None
        self._beat_s = self._alone_s = 0.0
        self._started: list[tuple[subprocess.Popen[bytes], IO[bytes]]] = []

    async def run(self) -> None:
        """Serve until this is cancelled, or a page of a run has no session any more."""
        self._start_page()
        watch = asyncio.create_task(self._watch())
        try:
            await self._server.begin()
            await self._server.serve()
        finally:
            watch.cancel()
            self._end_page()

    async def _watch(self) -> None:
        loop = asyncio.get_running_loop()
        self._beat_s = self._alone_s = loop.time()
        self._places.sessions.setblocking(False)
        loop.add_reader(self._places.sessions, self._accept)
        while not self._is_over(loop.time()):
            self._watch_page(loop.time())
            self._watch_started()
            await asyncio.sleep(_PERIOD_S)
        self._server.leave()

    def _is_over(self, now_s: float) -> bool:
        if self._session is not None or self._starter_lives is None or self._starter_lives():
            self._alone_s = now_s
        return now_s - self._alone_s > _ALONE_S

    # sessions

    def _accept(self) -> None:
        with suppress(OSError):
            line, _ = self._places.sessions.accept()
            line.setblocking(False)
            visit = _Visit(line)
            self._visits.append(visit)
            asyncio.get_running_loop().add_reader(line, self._read, visit)

    def _read(self, visit: _Visit) -> None:
        for written in visit.lines.take():
            kind = written.get("kind")
            if kind == "session" and not visit.attached:
                self._attach(visit, written.get("card"))
            visit.ended_orderly |= kind == "ended"
        if visit.lines.ended:
            self._drop(visit)

    def _attach(self, visit: _Visit, card: object) -> None:
        """Show a session, unless another one is attached: then it is sent away, and comes again."""
        try:
            if self._session is not None:
                raise ValueError("the page shows another session")
            self._session = attach(card, visit.lines)
        except ValueError:
            visit.lines.ended = True
            return
        visit.attached = True
        self._button.attach(self._session)
        self._tell_page()

    def _drop(self, visit: _Visit) -> None:
        asyncio.get_running_loop().remove_reader(visit.line)
        visit.lines.close()
        self._visits.remove(visit)
        if visit.attached:
            self._session = None
            self._button.attach(None)
            self._send({"kind": "gone", "why": _LEFT if visit.ended_orderly else _GONE, "orderly": visit.ended_orderly})

    # the page's server

    def _start_page(self) -> None:
        ours, theirs = socket.socketpair()
        ours.setblocking(False)
        arguments = (self._settings, self._places.page, theirs)
        self._page = get_context("spawn").Process(target=serve_page, args=arguments, name="mimics page", daemon=True)
        with signals_blocked(*IGNORED), main_hidden():
            self._page.start()
        theirs.close()
        self._line, self._beats = ours, Lines(ours)
        if self._session is not None:
            self._tell_page()

    def _tell_page(self) -> None:
        assert self._session is not None
        self._send({"kind": "session", "card": self._session.card}, self._session.memory.segment.descriptor)

    def _send(self, content: object, descriptor: int | None = None) -> None:
        if self._line is not None:
            send_line(self._line, content, descriptor)

    def _watch_page(self, now_s: float) -> None:
        """Start the page's server again where it died, or gave no sign of life for long."""
        assert self._page is not None and self._beats is not None
        for line in self._beats.take():
            self._beat_s = now_s
            if line.get("kind") == "start" and self._session is None:
                self._start_session([str(word) for word in line.get("words", [])])
        if not self._page.is_alive() or now_s - self._beat_s > _HUNG_S:
            self._end_page()
            self._start_page()
            self._beat_s = now_s

    def _start_session(self, words: list[str]) -> None:
        """Start a session that outlives this process; one that fails to start says why."""
        errors = tempfile.TemporaryFile()
        command = [sys.executable, "-m", "mimics_app", *words]
        run = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=errors, stderr=errors, start_new_session=True)
        self._started.append((run, errors))

    def _watch_started(self) -> None:
        """Tell the page of started sessions that ended with an error before they were attached."""
        for run, errors in [each for each in self._started if each[0].poll() is not None]:
            self._started.remove((run, errors))
            errors.seek(0)
            lines = errors.read().decode(errors="replace").strip().splitlines()
            errors.close()
            if run.returncode and self._session is None:
                said = lines[-1] if lines else f"code {run.returncode}"
                self._send({"kind": "gone", "why": f"The session could not start or ended with an error: {said}"})

    def _end_page(self) -> None:
        if self._beats is not None:
            self._beats.close()
        if self._page is not None:
            self._page.kill()
            self._page.join()


@dataclass(frozen=True, slots=True)
class Serving:
    """How a page is to be served.

    Attributes:
        host: Address to listen at.
        port: Port of the page; 0: any free one.
        certificate: For TLS; None: without.
        operate: Whether there is a token that lets a page operate.
        idle: Whether the page's server runs only when nobody else wants the processor.
    """

    host: str
    port: int
    certificate: Certificate | None
    operate: bool
    idle: bool


def open_supervisor(
    serving: Serving, meeting: MeetingPlace, starter_lives: Callable[[], bool] | None
) -> tuple[Supervisor, PageAddress]:
    """Return what serves STOP and the page, and their addresses, which are published.

    Args:
        serving: How it is to be served.
        meeting: Where sessions find the page; it is prepared.
        starter_lives: See `Supervisor`.

    Raises:
        UsageError: A page is served already, or the port cannot be used.
    """
    if meeting.served() is not None:
        raise UsageError("an operator's page is served already", "close it, or use it: it shows every session")
    host = serving.host
    try:
        page, stop = listen(host, serving.port), listen(host, 0)
    except OSError as error:
        raise UsageError(f"port {serving.port} at {host}: {error.strerror}", "give another one with --port") from error
    hosts = ("127.0.0.1", "localhost") if host in ("127.0.0.1", "localhost") else (host,)
    ports = page.getsockname()[1], stop.getsockname()[1]
    access = Access(hosts, *ports, secure=serving.certificate is not None, tokens=new_tokens(operate=serving.operate))
    meeting.withdraw()
    sessions = socket.socket(socket.AF_UNIX)
    sessions.bind(str(meeting.socket))
    sessions.listen(_VISITORS)
    address = PageAddress(access.address("operate"), access.address("view"), access.stop_origin(hosts[0]), os.getpid())
    meeting.publish(address)
    settings = PageSettings(access, serving.certificate, serving.idle)
    return Supervisor(settings, _Places(stop, page, sessions), starter_lives), address
