"""The operator's page of a run: started in processes of its own, or found where one is served already."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec

from mimics_app.console.meeting_place import MeetingPlace, has_unix_sockets
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError, UsageError

__all__ = ["DEFAULT_PORT", "can_serve", "check_console", "open_page", "start_page"]

DEFAULT_PORT = 8765
"""Port of the page where none is given."""
_PACKAGES = ("starlette", "trustme", "uvicorn", "websockets")
_WAIT_NS = 20_000_000_000
"""Time-out of the page's start [ns]."""
_STEP_NS = 50_000_000


def can_serve() -> bool:
    """Whether this installation and system can serve the page."""
    return has_unix_sockets() and all(find_spec(name) is not None for name in _PACKAGES)


def check_console() -> None:
    """Check that this installation can serve the page.

    Raises:
        UsageError: Packages of the extra are missing.
        DeviceError: This system cannot share a session's memory with a process that started earlier.
    """
    missing = [name for name in _PACKAGES if find_spec(name) is None]
    if missing:
        raise UsageError(f"the operator's page needs {', '.join(missing)}", "pip install 'mimics_app[console]'")
    if not has_unix_sockets():
        raise DeviceError("the operator's page needs Unix sockets, which this system lacks", "use Linux or macOS")


def start_page(port: int) -> None:
    """Start the page for this run; it prints its address itself, and waits where another one is served already.

    It is a process of its own session, so that Ctrl-C and a crash of the run leave it to say what happened. It ends a
    minute after the last session, once this process is gone.

    Raises:
        UsageError: Packages are missing.
        DeviceError: This system cannot serve it.
    """
    check_console()
    words = ["console", "--port", str(port), "--for-run", str(os.getpid())]
    subprocess.Popen([sys.executable, "-m", "mimics_app", *words], start_new_session=True, stdout=sys.stderr)


def open_page(port: int) -> None:
    """Start the page and open it in the browser of this user, who moves it to the second screen.

    One that is served already is open already: it shows the next session, too.
    """
    import webbrowser

    if MeetingPlace().served() is not None:
        return
    start_page(port)
    clock: Clock = MonotonicClock()
    deadline = clock.now_ns() + _WAIT_NS
    while (address := MeetingPlace().served()) is None and clock.now_ns() < deadline:
        clock.sleep_until_ns(clock.now_ns() + _STEP_NS)
    if address is not None:
        webbrowser.open(address.url)
