"""What stands before both servers: it checks Host and Origin, and gives every answer strict headers."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from mimics_app.console.access import Access

__all__ = ["Guard", "read_body"]

_LONGEST_BODY = 4096
_BODY_S = 2.0
"""Time in which a body must have arrived [s]."""

_HEADERS = {
    "x-frame-options": "DENY",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cache-control": "no-store",
}


class Guard:
    """ASGI application before another one.

    Args:
        app: The application.
        access: Who may reach it.
        port: Port of the server.
        policy: Content security policy of its answers.
    """

    def __init__(self, app: ASGIApp, access: Access, port: int, policy: str) -> None:
        self._app, self._access, self._port = app, access, port
        self._headers: Mapping[str, str] = {**_HEADERS, "content-security-policy": policy}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse a request, or pass it on."""
        headers = Headers(scope=scope)
        status, why = self._refusal(scope, headers)
        if status and scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": why})
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(self._headers)
            await send(message)

        app = PlainTextResponse(f"{why}\n", status) if status else self._app
        await app(scope, receive, send_with_headers)

    def _refusal(self, scope: Scope, headers: Headers) -> tuple[int, str]:
        """Return status and reason of a refusal; (0, "") for none."""
        if not self._access.allows_host(headers.get("host", ""), self._port):
            return 400, "unknown host"
        changes = scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD")
        if changes and not self._access.allows_origin(headers.get("origin", "")):
            return 403, "foreign or missing origin"
        return 0, ""


async def read_body(request: Request) -> bytes | None:
    """Return the body of a request; None where it is too long or does not arrive in time."""
    body = bytearray()

    async def read() -> bool:
        async for part in request.stream():
            body.extend(part)
            if len(body) > _LONGEST_BODY:
                return False
        return True

    try:
        whole = await asyncio.wait_for(read(), _BODY_S)
    except TimeoutError:
        return None
    return bytes(body) if whole else None
