"""Server of the operator's page, in a process of the idle scheduling class: its load, crash or hang stops nothing."""

from __future__ import annotations

import asyncio
import mimetypes
import os
import re
import socket
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket, WebSocketDisconnect

from mimics_app.console.access import COOKIE, Access
from mimics_app.console.clients import ASK_FIRST, VIEWS, Client, Clients
from mimics_app.console.guard import Guard, read_body
from mimics_app.console.handover import Lines, attach, send_line
from mimics_app.console.participant_forms import FormRequest, answer_of_form, why_no_form
from mimics_app.console.readiness import Choice, find_choices, find_lights, find_people, start_words
from mimics_app.console.session_view import SessionView, compressed
from mimics_app.console.telemetry import MIRROR, TELEMETRY, VALUES, message
from mimics_app.console.web_server import Certificate, WebServer
from mimics_app.contracts.system import language
from mimics_app.contracts.system.child_signals import ignore_signals

__all__ = ["IGNORED", "PageServer", "PageSettings", "serve_page"]

_PAGE = Path(__file__).parent / "page"
_SUFFIXES = (".html", ".js", ".css", ".svg", ".LICENSE")
_TYPES = {".js": "text/javascript", ".LICENSE": "text/plain"}

_LONGEST = 200
"""Length of a header that is read [characters]."""
_TAG = re.compile(r"([A-Za-z]{2,3})(?:-[A-Za-z0-9]+)*")


def page_files() -> dict[str, tuple[bytes, str]]:
    """Return the files of the page: path -> content and media type; nothing else can be requested."""
    files = {}
    for path in sorted(_PAGE.rglob("*")):
        if path.suffix in _SUFFIXES:
            kind = _TYPES.get(path.suffix) or mimetypes.guess_type(path.name)[0] or "text/plain"
            files["/" + path.relative_to(_PAGE).as_posix()] = path.read_bytes(), kind
    return files


def catalogue(accepted: str) -> dict[str, object]:
    """Return the language that the reader prefers of those there are, its texts and plural forms by the English ones.

    Args:
        accepted: Value of the Accept-Language header.
    """
    wanted = [match.group(1).lower() for part in accepted[:_LONGEST].split(",") if (match := _TAG.match(part.strip()))]
    code = next((each for each in wanted if each in language.LANGUAGES), language.SOURCE)
    if code == language.SOURCE:
        return {"language": code, "texts": {}, "plurals": {}}
    return {"language": code, "texts": dict(language.catalogue(code)), "plurals": dict(language.plural_forms(code))}


IGNORED = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals of the terminal, which the process that serves STOP answers for both."""

_PERIOD_S = 1.0 / 60.0
_SLOW = 6
"""Passes between two looks at what changes slowly."""
_BEAT = 60
"""Passes between two signs of life to the process that serves STOP."""
_BEFORE = ("choices", "people", "check", "form")
"""Requests before a session; each is about studies and their participants."""
_MOST_CLIENTS = 16
_NO_TICKS = message(TELEMETRY, b"")
"""Sign of life while the loop makes no ticks."""
_LOWEST = 19
"""Lowest priority."""


class _Token(msgspec.Struct, forbid_unknown_fields=True):
    """Body of a request for a cookie."""

    token: str


_NO_COMMAND = msgspec.Raw(b"")


class _Ask(msgspec.Struct, forbid_unknown_fields=True):
    """Request of a client: a command, or something of the server by name.

    Attributes:
        id: Its number, larger than that of the one before.
        command: A command to the session; empty: none.
        ask: A request to the server.
        choice: Of requests before a session: what was chosen.
        form: Of "form": what is wanted of a participant's forms.
        view: Of "look": the view to show beside the person's picture; "": none.
    """

    id: int
    command: msgspec.Raw = _NO_COMMAND
    ask: str = ""
    choice: Choice | None = None
    form: FormRequest | None = None
    view: Annotated[str, Meta(max_length=80)] = ""


_TOKENS = msgspec.json.Decoder(_Token)
_ASKS = msgspec.json.Decoder(_Ask)


class PageServer:
    """Passes on what the attached session publishes, and commands of the operator.

    Args:
        access: Who may reach the page.
        line: Connection to the process that serves STOP.
    """

    def __init__(self, access: Access, line: socket.socket) -> None:
        self._access, self._line, self._lines = access, line, Lines(line)
        self._clients = Clients(_MOST_CLIENTS)
        self._files = page_files()
        self._session: SessionView | None = None
        self._gone: dict[str, Any] = {}
        self._passes = 0
        self._deeds: dict[str, Callable[[Client], str]] = {
            "operate": self._clients.ask,
            "hand_over": lambda client: self._clients.grant(client, accept=True),
            "keep": lambda client: self._clients.grant(client, accept=False),
            "picture_on": lambda client: _watch(client, on=True),
            "picture_off": lambda client: _watch(client, on=False),
            "mirror_on": _follow,
        }

    def app(self) -> ASGIApp:
        """Return the application."""
        routes = [
            Route("/enter", self._enter, methods=["POST"]),
            Route("/texts", _texts, methods=["GET"]),
            WebSocketRoute("/live", self._live),
            Route("/{path:path}", self._file, methods=["GET"]),
        ]

        stops = " ".join(self._access.stop_origin(host) for host in self._access.hosts)
        policy = (
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
            f"connect-src 'self' {stops}; "
            "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )
        return Guard(Starlette(routes=routes), self._access, self._access.page_port, policy)

    async def run(self) -> None:
        """Pass on news, sixty times a second, until the other process is gone."""
        loop = asyncio.get_running_loop()
        due = loop.time()
        pictures = asyncio.create_task(self._pass_pictures())
        while not self._lines.ended:
            self._pass()
            due = max(due + _PERIOD_S, loop.time() - _PERIOD_S)
            await asyncio.sleep(due - loop.time())
        pictures.cancel()

    # requests

    async def _file(self, request: Request) -> Response:
        found = self._files.get("/" + (request.path_params["path"] or "index.html"))
        if found is None:
            return Response("no such page\n", 404, media_type="text/plain")
        return Response(found[0], media_type=found[1])

    async def _enter(self, request: Request) -> Response:
        try:
            token = _TOKENS.decode(await read_body(request) or b"").token
        except (ValueError, RecursionError, msgspec.DecodeError):  # ValueError: bytes that are no UTF-8
            return JSONResponse({"why": "not a token"}, 400)
        role = self._access.role_of_token(token)
        if role is None:
            return JSONResponse({"why": "unknown token"}, 403)
        answer = JSONResponse({"role": role})
        answer.set_cookie(
            COOKIE, self._access.cookie(role), httponly=True, samesite="strict", secure=self._access.secure
        )
        return answer

    async def _live(self, socket: WebSocket) -> None:
        role = self._access.role_of_cookies(socket.headers.get("cookie", ""))
        if role is None or self._clients.full:
            await socket.close(1008, "no cookie of this page" if role is None else "too many pages are open")
            return
        await socket.accept()
        client = self._clients.join(socket, role, is_display="display" in socket.query_params)
        stop = f"{self._access.stop_origin(socket.url.hostname or '')}/stop"
        client.tell({"kind": "hello", "values": VALUES, "stop": stop})
        self._tell_session(client)
        self._clients.tell_roles()
        writer = asyncio.create_task(client.write())
        try:
            while not writer.done():
                self._take(client, await socket.receive_text())
        except (WebSocketDisconnect, KeyError, RuntimeError):  # closed; a binary message; closed by the writer
            pass
        finally:
            writer.cancel()
            self._clients.leave(client)

    def _take(self, client: Client, text: str) -> None:
        """Carry out a request, and answer it unless the session does."""
        try:
            ask = _ASKS.decode(text.encode())
        except (msgspec.DecodeError, UnicodeEncodeError) as error:
            client.tell({"kind": "answer", "id": -1, "done": False, "why": f"not a request: {error}"})
            return
        why = client.may_ask(ask.id, asyncio.get_running_loop().time())
        if not why and ask.ask in _BEFORE:
            why = why_no_form(client, ask.form) if ask.ask == "form" else "" if client.may_operate else VIEWS
            if not why:
                asyncio.get_running_loop().create_task(_prepare(client, ask))
                return
        why = why or self._do(client, ask)
        if why or not bytes(ask.command):
            client.tell({"kind": "answer", "id": ask.id, "done": not why, "why": why})

    def _do(self, client: Client, ask: _Ask) -> str:
        if ask.ask == "start":
            return self._start(client, ask.choice)
        if ask.ask and ask.ask != "look":
            deed = self._deeds.get(ask.ask)
            return "unknown request" if deed is None else deed(client)
        if not client.operates:
            return ASK_FIRST
        if self._session is None:
            return "no session is attached"
        if ask.ask:
            return self._session.show_second(ask.view)
        return self._session.give(client, ask.id, bytes(ask.command))

    def _start(self, client: Client, choice: Choice | None) -> str:
        """Let the process that serves STOP start a session: of the usual priority, and not to end with this one."""
        if not client.operates:
            return ASK_FIRST
        if choice is None or self._session is not None:
            return "a session is attached already" if choice else "nothing was chosen"
        send_line(self._line, {"kind": "start", "words": start_words(choice)})
        return ""

    # news

    def _pass(self) -> None:
        self._passes += 1
        self._take_lines()
        if self._passes % _BEAT == 0:
            send_line(self._line, {"kind": "beat"})
        session = self._session
        if session is None:
            if self._passes % _SLOW == 0:
                self._show(TELEMETRY, _NO_TICKS)
            return
        session.attend(
            operators=self._clients.operators, watchers=self._clients.watchers, mirrors=self._clients.mirrors
        )
        self._show(TELEMETRY, session.telemetry.newest() or _NO_TICKS)
        if self._clients.mirrors and (frame := session.mirror.read()) is not None:
            self._each(partial(_show_mirror, message(MIRROR, frame)))
        if (signals := session.signals()) is not None:
            self._each(lambda client: client.append(signals))
        for client, answer in session.answers():
            if isinstance(client, Client):
                client.tell(answer)
        self._pass_status(session)

    async def _pass_pictures(self) -> None:
        """Compress pictures one after the other, in a thread: what waits meanwhile is only the newest."""
        while True:
            await asyncio.sleep(_PERIOD_S)
            session = self._session
            if session is None or not self._clients.watchers:
                continue
            for kind, reader in session.pictures.items():
                if (content := reader.read()) is not None:
                    picture = message(kind, await asyncio.to_thread(compressed, content))
                    self._each(partial(_show_picture, kind, picture))

    def _pass_status(self, session: SessionView) -> None:
        news = session.take_status()
        if news is None:
            return
        status, fresh = news
        self._each(lambda client: client.tell({"kind": "status", "status": status}))
        for name, entries in fresh.items():
            if entries:
                self._each(partial(_tell_entries, name, entries))

    def _take_lines(self) -> None:
        for line in self._lines.take():
            if line.get("kind") == "session":
                self._session, self._gone = SessionView(attach(line["card"], self._lines)), {}
            else:
                self._session, self._gone = None, line
            self._each(self._tell_session)

    def _tell_session(self, client: Client) -> None:
        """Tell a page which session is attached, with what has happened in it so far."""
        session = self._session
        left = {"why": self._gone.get("why", ""), "orderly": self._gone.get("orderly", False)}
        card = None if session is None else session.card.shown(may_operate=client.may_operate)
        client.tell({"kind": "session", "card": card, **left})
        if session is not None:
            client.tell({"kind": "status", "status": session.status})
            for name, entries in session.kept.items():
                _tell_entries(name, entries, client)

    def _show(self, kind: int, content: bytes) -> None:
        self._each(lambda client: client.show(kind, content))

    def _each(self, deed: Callable[[Client], None]) -> None:
        for client in self._clients.open:
            deed(client)


async def _texts(request: Request) -> Response:
    return JSONResponse(catalogue(request.headers.get("accept-language", "")))


async def _prepare(client: Client, ask: _Ask) -> None:
    """Answer what and who can be chosen, the lights of a choice, or of a participant's forms; each takes seconds."""
    if ask.ask == "choices":
        client.tell({"kind": "answer", "id": ask.id, "done": True, "why": "", "choices": await find_choices()})
    elif ask.ask == "people":
        client.tell({"kind": "answer", "id": ask.id, "done": True, "why": "", "people": await find_people()})
    elif ask.form is not None and ask.ask == "form":
        client.tell({"kind": "answer", "id": ask.id, **await answer_of_form(ask.form)})
    elif ask.choice is not None:
        client.tell({"kind": "answer", "id": ask.id, "done": True, "why": "", "lights": await find_lights(ask.choice)})


def _watch(client: Client, *, on: bool) -> str:
    client.wants_picture = on
    return ""


def _follow(client: Client) -> str:
    client.wants_mirror = True
    return ""


def _show_mirror(frame: bytes, client: Client) -> None:
    if client.wants_mirror:
        client.show(MIRROR, frame)


def _show_picture(kind: int, picture: bytes, client: Client) -> None:
    if client.wants_picture:
        client.show(kind, picture)


def _tell_entries(name: str, entries: list[dict[str, Any]], client: Client) -> None:
    client.tell({"kind": name, "entries": entries})


@dataclass(frozen=True, slots=True)
class PageSettings:
    """What the page's server is given.

    Attributes:
        access: Who may reach the page.
        certificate: For TLS; None: without.
        idle: Whether it runs only when nobody else wants the processor.
    """

    access: Access
    certificate: Certificate | None
    idle: bool


def serve_page(settings: PageSettings, place: socket.socket, line: socket.socket) -> None:
    """Serve the page until the process that serves STOP is gone. Target of the spawned process.

    Args:
        settings: What it is given.
        place: Listening socket.
        line: Connection to the process that serves STOP.
    """
    ignore_signals(*IGNORED)
    asyncio.run(_serve(settings, place, line))


async def _serve(settings: PageSettings, place: socket.socket, line: socket.socket) -> None:
    page = PageServer(settings.access, line)
    server = WebServer(page.app(), place, settings.certificate)
    await server.begin()
    if settings.idle:  # from here on: a start in the idle class could take minutes on a busy computer
        _lower_this_process()
    serving: Awaitable[None] = asyncio.create_task(server.serve())
    await page.run()
    server.leave()
    await serving


def _lower_this_process() -> None:
    """Put this process into the idle scheduling class, where the system has one, and else to the lowest priority.

    Lower priority alone does not keep it off the haptic loop: beside a process at nice 10 that loop was up to 5.9 ms
    late, beside an idle one as without it.
    """
    if hasattr(os, "nice"):
        os.nice(_LOWEST)
    if hasattr(os, "sched_setscheduler"):
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
