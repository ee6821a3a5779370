"""STOP of the operator's page: a server of its own in a process of normal priority, which does nothing else."""

from __future__ import annotations

from collections import OrderedDict

import msgspec
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp

from mimics_app.console.access import Access
from mimics_app.console.guard import Guard, read_body
from mimics_app.console.handover import AttachedSession
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Stop
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.shared_memory.command_ring import CommandSender

__all__ = ["StopButton", "stop_app"]

_KEPT_NONCES = 4096
_POLICY = "default-src 'none'; frame-ancestors 'none'"


class _Press(msgspec.Struct, forbid_unknown_fields=True):
    """Body of a request: a text that no other press has."""

    nonce: str


_PRESSES = msgspec.json.Decoder(_Press)


class StopButton:
    """Writes the stop word of the session that is attached."""

    def __init__(self) -> None:
        self._clock: Clock = MonotonicClock()
        self._sender: CommandSender | None = None
        self._seen: OrderedDict[str, None] = OrderedDict()

    def attach(self, session: AttachedSession | None) -> None:
        """Stop this session from now on; None: there is none."""
        source = CommandSource.STOP_BUTTON
        self._sender = None if session is None else CommandSender(session.memory, source, "operator's STOP")

    def is_new(self, nonce: str) -> bool:
        """Whether a press has not been seen before; it has been from now on."""
        if nonce in self._seen:
            return False
        self._seen[nonce] = None
        if len(self._seen) > _KEPT_NONCES:
            self._seen.popitem(last=False)
        return True

    def press(self) -> bool:
        """Take the force away; False where no session is attached. The word is written before anything can fail."""
        if self._sender is None:
            return False
        try:
            self._sender.send(Stop(), self._clock.now_ns())
        except UsageError:  # its line for the journal is lost, the stop word is raised
            return True
        return True


def stop_app(button: StopButton, access: Access) -> ASGIApp:
    """Return the application of STOP: POST /stop with the page's cookie and origin, and a new nonce."""

    async def stop(request: Request) -> Response:
        if access.role_of_cookies(request.headers.get("cookie", "")) != "operate":
            return _answer(request, 403, "only an operator may stop the session")
        try:
            nonce = _PRESSES.decode(await read_body(request) or b"").nonce
        except (ValueError, RecursionError, msgspec.DecodeError):
            return _answer(request, 400, "not a press of STOP")
        if not button.is_new(nonce):
            return _answer(request, 409, "this press was given before")
        return _answer(request, 200, "") if button.press() else _answer(request, 503, "no session is attached")

    app = Starlette(routes=[Route("/stop", stop, methods=["POST"])])
    return Guard(app, access, access.stop_port, _POLICY)


def _answer(request: Request, status: int, why: str) -> Response:
    """Return an answer that the page, whose origin the guard has checked, may read."""
    headers = {
        "access-control-allow-origin": request.headers["origin"],
        "access-control-allow-credentials": "true",
        "vary": "origin",
    }
    return JSONResponse({"stopped": status == 200, "why": why}, status, headers)
