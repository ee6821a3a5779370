"""`mimics console`: serve the operator's page, from which sessions of this computer are watched and steered."""

from __future__ import annotations

import argparse
import ipaddress
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.app.terminal.arguments import whole_number
from mimics_app.app.terminal.output import say
from mimics_app.contracts.clock import Clock, MonotonicClock

if TYPE_CHECKING:
    from mimics_app.console.meeting_place import MeetingPlace
    from mimics_app.console.web_server import Certificate

__all__ = ["add_arguments", "run"]

_PORT = 8765
"""As `play.operators_page.DEFAULT_PORT`, so that --help imports none of it."""
_EVERYWHERE = ("0.0.0.0", "::", "")
_WAIT_NS = 500_000_000
"""Period in which a page of a run looks whether it is needed [ns]."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics console`."""
    parser.epilog = (
        "The page shows each session that runs on this computer, and stays between sessions. The address printed holds "
        "a secret: who has it may operate. Ctrl-C ends the page; a session is not touched by that."
    )
    parser.add_argument(
        "--port", type=whole_number("port", range(65536)), default=_PORT, help="port of the page (0: any free one)"
    )
    parser.add_argument(
        "--host", default="127.0.0.1", help="address to serve at; any but that of this computer itself is served by TLS"
    )
    parser.add_argument(
        "--certificate", type=Path, metavar="FILE", help="certificate for TLS (PEM); without it one is made and kept"
    )
    parser.add_argument("--key", type=Path, metavar="FILE", help="key of the certificate (PEM)")
    parser.add_argument(
        "--lan-operate", action="store_true", help="let pages at other computers operate, not only view"
    )
    parser.add_argument(
        "--priority",
        choices=("idle", "usual"),
        default="idle",
        help="idle: the page gets the processor when nobody else wants it, so that it cannot disturb the haptic loop; "
        "usual: on a computer that is busy with something else; STOP has the usual priority in any case",
    )
    parser.add_argument("--for-run", type=int, default=0, metavar="PID", help=argparse.SUPPRESS)


def run(args: argparse.Namespace) -> int:
    """Serve until Ctrl-C, or until the run that started it is over."""
    from mimics_app.app.play.operators_page import check_console
    from mimics_app.console.meeting_place import MeetingPlace

    check_console()
    certificate = _certificate(args)
    import asyncio

    from mimics_app.console.supervisor import Serving, open_supervisor

    meeting = MeetingPlace()
    meeting.prepare()
    starter = args.for_run
    lives = (lambda: _lives(starter)) if starter else None
    if not _is_free(meeting, lives):
        return 0
    operate = _is_loopback(args.host) or args.lan_operate
    serving = Serving(args.host, args.port, certificate, operate=operate, idle=args.priority == "idle")
    supervisor, address = open_supervisor(serving, meeting, lives)
    shown = address.url or address.view_url
    if args.json:
        from mimics_app.app.terminal.output import answer

        answer(args, {"url": address.url, "view_url": address.view_url, "pid": address.pid}, ())
    else:
        say(f"operator's page: {shown}")
        if certificate is not None:
            from mimics_app.console.own_certificate import fingerprint

            say(f"fingerprint of its certificate, as the browser shows it (SHA-256): {fingerprint(certificate)}")
    try:
        asyncio.run(supervisor.run())
    finally:
        meeting.withdraw()
    return 0


def _is_free(meeting: MeetingPlace, starter_lives: Callable[[], bool] | None) -> bool:
    """Whether no page is served. That of a run waits, as one that is served now may end before the run's session."""
    clock: Clock = MonotonicClock()
    while starter_lives is not None and meeting.served() is not None:
        if not starter_lives():
            return False
        clock.sleep_until_ns(clock.now_ns() + _WAIT_NS)
    return True


def _lives(pid: int) -> bool:
    """Whether a process runs. One that ended does not, though its parent has not yet asked how: it may wait for us."""
    try:
        os.kill(pid, 0)
    except OSError:
        return False
    with suppress(OSError):  # only Linux has this file
        return Path(f"/proc/{pid}/stat").read_bytes().rpartition(b") ")[2][:1] != b"Z"
    return True


def _is_loopback(host: str) -> bool:
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _certificate(args: argparse.Namespace) -> Certificate | None:
    """Return the certificate; for another address than this computer's one is made where none is given."""
    from mimics_app.contracts.errors import OutputError, UsageError

    if args.host in _EVERYWHERE:
        raise UsageError(f"--host {args.host} is not an address that a browser can open", "give this computer's own")
    if args.certificate is None and args.key is None:
        if _is_loopback(args.host):
            return None
        from mimics_app.app.terminal.user_files import config_folder
        from mimics_app.console.own_certificate import own_certificate

        folder = config_folder() / "certificates"
        try:
            return own_certificate(folder, args.host)
        except OSError as error:
            raise OutputError(folder, str(error.strerror), "give --certificate FILE and --key FILE") from error
    if args.certificate is None or args.key is None:
        raise UsageError("--certificate and --key belong together", "give both")
    for file in (args.certificate, args.key):
        if not file.is_file():
            raise UsageError(f"{file}: not found", "name a PEM file")
    from mimics_app.console.web_server import Certificate

    return Certificate(str(args.certificate), str(args.key))
