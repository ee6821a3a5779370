"""Where sessions and the operator's page of one user find each other: a private folder with a socket and an address.

A session offers itself by passing the descriptor of its memory over the socket. The connection is the sign of life: the
kernel closes it with the process, however that ends.
"""

from __future__ import annotations

import json
import os
import stat
import tempfile
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from mimics_app.contracts.errors import OutputError
from mimics_app.contracts.system.regular_file import read_regular

__all__ = ["MeetingPlace", "PageAddress", "has_unix_sockets"]

_PRIVATE = 0o700
_MOST_BYTES = 4096


@dataclass(frozen=True, slots=True)
class PageAddress:
    """Address of a page that is served.

    Attributes:
        url: Address with the operator's token in its fragment.
        view_url: The same for those who only look.
        stop_url: Address of STOP.
        pid: Process that serves STOP and supervises the page.
    """

    url: str
    view_url: str
    stop_url: str
    pid: int


def has_unix_sockets() -> bool:
    """Whether this system can pass a descriptor to another process over a socket."""
    import socket

    return hasattr(socket, "AF_UNIX") and hasattr(socket, "send_fds")


class MeetingPlace:
    """The folder: in XDG_RUNTIME_DIR, which is the user's own, else in the folder of temporary files.

    Raises:
        OutputError: The folder belongs to somebody else, or is a link.
    """

    def __init__(self) -> None:
        runtime = os.environ.get("XDG_RUNTIME_DIR", "")
        user = os.getuid() if hasattr(os, "getuid") else 0
        self._folder = Path(runtime) / "mimics" if runtime else Path(tempfile.gettempdir()) / f"mimics-{user}"
        self._user = user

    @property
    def socket(self) -> Path:
        """Path of the socket at which the page waits for sessions."""
        return self._folder / "console.sock"

    @property
    def address_file(self) -> Path:
        """Path of the file with the address of the page."""
        return self._folder / "console.json"

    def prepare(self) -> None:
        """Make the folder, private to this user.

        Raises:
            OutputError: It cannot be made, or is another user's.
        """
        try:
            self._folder.mkdir(mode=_PRIVATE, parents=True, exist_ok=True)
            found = self._folder.lstat()
            if not stat.S_ISDIR(found.st_mode) or (hasattr(os, "getuid") and found.st_uid != self._user):
                raise OutputError(self._folder, "is not a folder of this user", "remove it, or set XDG_RUNTIME_DIR")
            self._folder.chmod(_PRIVATE)
        except OSError as error:
            raise OutputError(self._folder, str(error.strerror), "set XDG_RUNTIME_DIR to a folder of yours") from error

    def publish(self, address: PageAddress) -> None:
        """Write the address, for sessions that start later and for the launcher."""
        scratch = self.address_file.with_suffix(".part")
        scratch.unlink(missing_ok=True)
        descriptor = os.open(scratch, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(descriptor, "w", encoding="utf-8") as file:
            json.dump(asdict(address), file)
        os.replace(scratch, self.address_file)

    def withdraw(self) -> None:
        """Remove socket and address."""
        for path in (self.socket, self.address_file):
            with suppress(OSError):
                path.unlink(missing_ok=True)

    def served(self) -> PageAddress | None:
        """Return the address of the page that runs now; None where there is none."""
        try:
            address = PageAddress(**json.loads(read_regular(self.address_file, _MOST_BYTES)))
            os.kill(address.pid, 0)
        except (OSError, ValueError, TypeError):
            return None
        return address
