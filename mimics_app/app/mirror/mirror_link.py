"""Connection of a mirror to the operator's page of a session: frames come, nothing is sent but the wish for them."""

from __future__ import annotations

import json
import ssl
import urllib.error
import urllib.request
from pathlib import Path
from threading import Event, Thread
from typing import Any

from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.sync.client import connect
from websockets.typing import Origin

from mimics_app.app.mirror.mirror_buffer import MirrorBuffer
from mimics_app.console.telemetry import HEADER_BYTES, MIRROR
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.messages.mirror_frame import read_frame

__all__ = ["MirrorLink"]

_AGAIN_S = 1.0
_ANSWER_S = 20.0
_LARGEST = 1 << 23
"""Longest message [bytes]."""


class MirrorLink:
    """Receives frames in a thread of its own, and connects again where the connection is lost.

    Args:
        url: Address of the page with its token, as the program prints it; that for viewing is enough.
        buffer: Takes the frames.
        certificate: Certificate to be trusted besides those of the system; None: none.

    Attributes:
        card: Scene and hash of the session, once one is attached; None before.
        why: Why there is no session now, for people.

    Raises:
        UsageError: It is not such an address.
        DeviceError: The page does not answer, or does not know the token.
    """

    def __init__(self, url: str, buffer: MirrorBuffer, certificate: Path | None) -> None:
        self._origin, hashed, token = url.partition("/#")
        if not hashed or not self._origin.startswith(("http://", "https://")):
            raise UsageError(f"{url} is not the address of an operator's page", "copy it with its part after the #")
        self._buffer, self._clock = buffer, MonotonicClock()
        self._trust = None
        if self._origin.startswith("https"):
            self._trust = ssl.create_default_context(cafile=None if certificate is None else str(certificate))
            self._trust.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
        self.card: dict[str, Any] | None = None
        self.why = "there is no session yet"
        self._over = Event()
        self._cookie = self._enter(token)
        self._thread = Thread(target=self._run, name="mirror", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Leave the page."""
        self._over.set()
        self._thread.join(2.0 * _AGAIN_S)

    def _enter(self, token: str) -> str:
        body, headers = json.dumps({"token": token}).encode(), {"origin": self._origin}
        request = urllib.request.Request(f"{self._origin}/enter", body, headers)
        try:
            with urllib.request.urlopen(request, timeout=_ANSWER_S, context=self._trust) as answer:
                return str(answer.headers["set-cookie"]).partition(";")[0]
        except urllib.error.HTTPError as error:
            with error:
                raise DeviceError("the page does not know this token", "copy the address that it printed") from error
        except OSError as error:
            raise DeviceError(f"{self._origin} does not answer: {error}", "is mimics console running there?") from error

    def _run(self) -> None:
        while not self._over.is_set():
            try:
                self._listen()
            except (OSError, WebSocketException):
                self.why = "the connection is lost; it is sought again"
            self._over.wait(_AGAIN_S)

    def _listen(self) -> None:
        address = self._origin.replace("http", "ws", 1) + "/live?display"
        headers, clock = {"Cookie": self._cookie}, self._clock
        with connect(
            address, origin=Origin(self._origin), additional_headers=headers, ssl=self._trust, max_size=_LARGEST
        ) as client:
            client.send(json.dumps({"id": 1, "ask": "mirror_on"}))
            while not self._over.is_set():
                try:
                    self._take(client.recv(timeout=_AGAIN_S), clock)
                except TimeoutError:
                    continue
                except ConnectionClosed:
                    return

    def _take(self, message: str | bytes, clock: Clock) -> None:
        if isinstance(message, str):
            said = json.loads(message)
            if said["kind"] == "session":
                self.card, self.why = said["card"], said.get("why", "") or "there is no session"
        elif int.from_bytes(message[:4], "little") == MIRROR:
            self._buffer.put(read_frame(message[HEADER_BYTES:]), clock.now_ns())
