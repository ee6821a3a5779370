"""uvicorn with limits: connections that send no request are closed soon, and the oldest of them when there are many."""

from __future__ import annotations

import asyncio
import socket
from dataclasses import dataclass
from typing import ClassVar

import h11
import uvicorn
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

__all__ = ["Certificate", "WebServer", "listen"]

_MOST_SILENT = 64
"""Largest number of connections that have not sent a whole request."""
_SILENT_S = 3.0
"""Time in which a request must have arrived [s]."""
_LONGEST_FRAME = 16384
"""Longest message of a client over the socket [bytes]."""
_BACKLOG = 1024


@dataclass(frozen=True, slots=True)
class Certificate:
    """Files of a certificate for TLS, and of its key."""

    certificate: str
    key: str


class _LimitedHttp(H11Protocol):
    """HTTP of one connection, which must send its request in time."""

    silent: ClassVar[dict[_LimitedHttp, asyncio.TimerHandle]] = {}
    """Connections without a request, the oldest first, and what closes each."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self.silent[self] = self.loop.call_later(_SILENT_S, transport.abort)
        if len(self.silent) > _MOST_SILENT:
            next(iter(self.silent)).transport.abort()

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        if self.cycle is not None:
            self._has_spoken()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        self._has_spoken()
        super().handle_websocket_upgrade(event)

    def connection_lost(self, exc: Exception | None) -> None:
        self._has_spoken()
        super().connection_lost(exc)

    def _has_spoken(self) -> None:
        if (timer := self.silent.pop(self, None)) is not None:
            timer.cancel()


class WebServer:
    """A server in the loop of its caller, which handles signals itself.

    Args:
        app: The application.
        place: Listening socket.
        certificate: For TLS; None: without.
    """

    def __init__(self, app: ASGIApp, place: socket.socket, certificate: Certificate | None) -> None:
        config = uvicorn.Config(
            app,
            http=_LimitedHttp,
            ws="websockets-sansio",
            ws_max_size=_LONGEST_FRAME,
            ws_ping_interval=5.0,
            ws_ping_timeout=5.0,
            lifespan="off",
            log_config=None,
            access_log=False,
            server_header=False,
            date_header=False,
            proxy_headers=False,
            timeout_graceful_shutdown=1,
            backlog=_BACKLOG,
            ssl_certfile=None if certificate is None else certificate.certificate,
            ssl_keyfile=None if certificate is None else certificate.key,
        )
        self._server = uvicorn.Server(config)
        self._place = place

    async def begin(self) -> None:
        """Accept connections from now on; signals are not touched."""
        self._server.config.load()
        self._server.lifespan = self._server.config.lifespan_class(self._server.config)
        await self._server.startup(sockets=[self._place])

    async def serve(self) -> None:
        """Serve until `leave`, after `begin`."""
        await self._server.main_loop()
        await self._server.shutdown(sockets=[self._place])

    def leave(self) -> None:
        """End `serve`."""
        self._server.should_exit = True


def listen(host: str, port: int) -> socket.socket:
    """Return a listening socket; port 0: any free one.

    Raises:
        OSError: The port is in use, or the address is not of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    place = socket.socket(family)
    place.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    place.bind((host, port))
    place.listen(_BACKLOG)
    return place
