"""Who may reach the operator's page: tokens, the cookie made of one, and the places that a request may come from."""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass, field
from hashlib import sha256
from http.cookies import CookieError, SimpleCookie
from typing import Literal

__all__ = ["COOKIE", "Access", "Role", "new_tokens"]

Role = Literal["operate", "view"]

COOKIE = "mimics_operator"
_TOKEN_BYTES = 32


def new_tokens(*, operate: bool) -> dict[Role, str]:
    """Return new tokens: one to view, and one to operate where that is allowed."""
    roles: tuple[Role, ...] = ("operate", "view") if operate else ("view",)
    return {role: secrets.token_urlsafe(_TOKEN_BYTES) for role in roles}


@dataclass(frozen=True, slots=True)
class Access:
    """Secrets of one page, and where it stands; the same in the process of STOP and in that of the page.

    Attributes:
        hosts: Names under which the page is reached, without a port.
        page_port: Port of the page.
        stop_port: Port of STOP.
        tokens: The token of each role that there is.
        secure: Whether both speak TLS.
        secret: Key of the cookies.
    """

    hosts: tuple[str, ...]
    page_port: int
    stop_port: int
    tokens: dict[Role, str]
    secure: bool = False
    secret: bytes = field(default_factory=lambda: secrets.token_bytes(_TOKEN_BYTES))

    @property
    def scheme(self) -> str:
        """Scheme of both addresses."""
        return "https" if self.secure else "http"

    def origin(self, host: str = "") -> str:
        """Return the origin of the page under one of its names."""
        return f"{self.scheme}://{host or self.hosts[0]}:{self.page_port}"

    def stop_origin(self, host: str) -> str:
        """Return the origin of STOP under one of its names."""
        return f"{self.scheme}://{host}:{self.stop_port}"

    def address(self, role: Role) -> str:
        """Return the page's address with the token of a role in the fragment, which no request carries; "": no role."""
        return f"{self.origin()}/#{self.tokens[role]}" if role in self.tokens else ""

    def allows_host(self, host: str, port: int) -> bool:
        """Whether a Host header names this page: a name that was made to resolve to it does not."""
        return host in {f"{name}:{port}" for name in self.hosts}

    def allows_origin(self, origin: str) -> bool:
        """Whether an Origin header is the page's own; an absent one is not."""
        return origin in {self.origin(name) for name in self.hosts}

    def role_of_token(self, token: str) -> Role | None:
        """Return the role of a token; None for a wrong one. Both are compared, each in constant time."""
        matches = {role: hmac.compare_digest(known.encode(), token.encode()) for role, known in self.tokens.items()}
        return next((role for role, same in matches.items() if same), None)

    def cookie(self, role: Role) -> str:
        """Return a new cookie of a role."""
        name = f"{role}.{secrets.token_urlsafe(9)}"
        return f"{name}.{self._seal(name)}"

    def role_of_cookies(self, header: str) -> Role | None:
        """Return the role that a Cookie header gives; None without a valid cookie."""
        try:
            morsel = SimpleCookie(header).get(COOKIE)
        except CookieError:
            return None
        name, _, seal = ("" if morsel is None else morsel.value).rpartition(".")
        if not hmac.compare_digest(self._seal(name).encode(), seal.encode("utf-8", "replace")):
            return None
        return "operate" if name.startswith("operate.") else "view"

    def _seal(self, name: str) -> str:
        return hmac.new(self.secret, name.encode("utf-8", "replace"), sha256).hexdigest()
