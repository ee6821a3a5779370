"""Clients of the page: what waits for each, which of them operates, and how often each may ask."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Mapping

import msgspec
from starlette.websockets import WebSocket

from mimics_app.console.access import Role

__all__ = ["ASK_FIRST", "VIEWS", "Client", "Clients"]

VIEWS = "this page was opened with an address for viewing"
"""Refusal of what a client may not do with its token."""
ASK_FIRST = "this page views; ask for the operator's place first"
"""Refusal of what only the client does that operates."""
_MOST_WAITING = 256
"""Texts that wait for a slow client before it is closed."""
_PER_SECOND, _AT_ONCE = 20.0, 40.0
"""Requests of one client: rate [1/s], and number at once."""


class Client:
    """One open page.

    Of binary messages a slow client gets the newest of each kind only, texts it gets all.

    Args:
        socket: Its connection, accepted.
        number: Its number at this server, for people.
        may_operate: Whether its token lets it operate.

    Attributes:
        operates: Whether it operates.
        wants_picture: Whether it shows the subject's picture.
        wants_mirror: Whether it is a second display.
        left_out: Binary messages that were replaced by newer ones.
    """

    def __init__(self, socket: WebSocket, number: int, *, may_operate: bool) -> None:
        self.number, self.may_operate = number, may_operate
        self.operates = self.wants_picture = self.wants_mirror = False
        self.left_out = 0
        self._socket = socket
        self._texts: deque[bytes] = deque()
        self._newest: dict[int, bytes] = {}
        self._series: deque[bytes] = deque(maxlen=_MOST_WAITING)
        self._ready = asyncio.Event()
        self._room, self._asked_s = _AT_ONCE, 0.0
        self._last_id = 0

    def tell(self, content: Mapping[str, object]) -> None:
        """Send a text; a client that takes none for long is closed."""
        self._texts.append(msgspec.json.encode(content))
        self._ready.set()

    def show(self, kind: int, content: bytes) -> None:
        """Send a binary message of which only the newest counts."""
        self.left_out += kind in self._newest
        self._newest[kind] = content
        self._ready.set()

    def append(self, content: bytes) -> None:
        """Send a binary message that continues a series; of a slow client the oldest are left out."""
        self.left_out += len(self._series) == self._series.maxlen
        self._series.append(content)
        self._ready.set()

    def may_ask(self, number: int, now_s: float) -> str:
        """Return why a request is refused: its number is not new, or there are too many; "" where it is not."""
        self._room = min(_AT_ONCE, self._room + (now_s - self._asked_s) * _PER_SECOND)
        self._asked_s = now_s
        if number <= self._last_id:
            return "this request was given before"
        self._last_id = number
        if self._room < 1.0:
            return "too many requests"
        self._room -= 1.0
        return ""

    async def write(self) -> None:
        """Send what waits until the connection ends, or the client is too slow for its texts."""
        while len(self._texts) <= _MOST_WAITING:
            await self._ready.wait()
            self._ready.clear()
            while self._texts:
                await self._socket.send_text(self._texts.popleft().decode())
            while self._series:
                await self._socket.send_bytes(self._series.popleft())
            newest, self._newest = self._newest, {}
            for content in newest.values():
                await self._socket.send_bytes(content)
        await self._socket.close(1013)


class Clients:
    """All open pages; at most one of them operates.

    Args:
        most: Largest number of them.

    Attributes:
        open: The clients, the oldest first.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self.open: list[Client] = []
        self._count = 0
        self._asking: Client | None = None

    @property
    def full(self) -> bool:
        """Whether no further page is accepted."""
        return len(self.open) >= self._most

    @property
    def operators(self) -> int:
        """Number of clients that operate."""
        return sum(client.operates for client in self.open)

    @property
    def watchers(self) -> int:
        """Number of clients that show the picture."""
        return sum(client.wants_picture for client in self.open)

    @property
    def mirrors(self) -> int:
        """Number of clients that are second displays."""
        return sum(client.wants_mirror for client in self.open)

    def join(self, socket: WebSocket, role: Role, *, is_display: bool = False) -> Client:
        """Add a page; the first that may operate does, but for a second display."""
        self._count += 1
        client = Client(socket, self._count, may_operate=role == "operate")
        client.operates = client.may_operate and not is_display and not self.operators
        self.open.append(client)
        return client

    def leave(self, client: Client) -> None:
        """Remove a page; if it operated, nobody does until one asks."""
        self.open.remove(client)
        if self._asking is client:
            self._asking = None
        self.tell_roles()

    def ask(self, client: Client) -> str:
        """Let a client operate, or ask the one that does; return a refusal or "".

        A request that the operator neither grants nor refuses is granted when it is made once more.
        """
        if not client.may_operate:
            return VIEWS
        holder = next((each for each in self.open if each.operates), None)
        if holder is None or self._asking is client:
            self._give(client)
        else:
            self._asking = client
        self.tell_roles()
        return ""

    def grant(self, client: Client, *, accept: bool) -> str:
        """Let the operator hand over to the client that asks, or refuse; return a refusal or ""."""
        if not client.operates or self._asking is None:
            return "nobody asks for the operator's place"
        if accept:
            self._give(self._asking)
        self._asking = None
        self.tell_roles()
        return ""

    def tell_roles(self) -> None:
        """Tell every page who operates and who asks."""
        holder = next((each.number for each in self.open if each.operates), None)
        asking = None if self._asking is None else self._asking.number
        for client in self.open:
            client.tell(
                {
                    "kind": "roles",
                    "client": client.number,
                    "operates": client.operates,
                    "may_operate": client.may_operate,
                    "operator": holder,
                    "asking": asking,
                    "clients": len(self.open),
                }
            )

    def _give(self, client: Client) -> None:
        for each in self.open:
            each.operates = each is client
        self._asking = None
