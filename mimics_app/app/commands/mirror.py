"""`mimics mirror URL`: show the scene of a session on a second display, also of another computer, from its state."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimics_app.app.terminal.arguments import add_window_size_argument, picture_file, positive_time
from mimics_app.app.terminal.output import answer

__all__ = ["add_arguments", "run"]

_DELAY_S = 0.1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics mirror`."""
    parser.epilog = (
        "URL is the address that mimics console or mimics run --console prints; that for viewing is enough, unless "
        "the scene is changed for its person (fitted, mirrored, with an own body). The files "
        "of the scene must be on this computer. Nothing is sent to the session. V and 1 to 9 show its views; "
        "Esc leaves."
    )
    parser.add_argument("url", metavar="URL", help="address of the operator's page, with its part after the #")
    parser.add_argument("--scene", default="", metavar="SCENE", help="scene file, where it is not found by its name")
    parser.add_argument("--camera", default="", metavar="NAME", help="view that is shown first")
    parser.add_argument(
        "--delay",
        type=positive_time,
        default=_DELAY_S,
        metavar="S",
        help="time by which the mirror is behind: frames that are late by less are in their place [s]",
    )
    parser.add_argument("--certificate", type=Path, metavar="FILE", help="certificate of the page to be trusted (PEM)")
    parser.add_argument("--seconds", type=positive_time, metavar="S", help="leave after this time [s]")
    parser.add_argument("--output", type=picture_file, metavar="PNG", help="no window: draw the last state to a file")
    add_window_size_argument(parser)


def run(args: argparse.Namespace) -> int:
    """Show the session until the window is closed."""
    from mimics_app.app.play.operators_page import check_console

    check_console()
    from mimics_app.app.mirror.mirror_buffer import MirrorBuffer
    from mimics_app.app.mirror.mirror_display import MirrorDisplay
    from mimics_app.app.mirror.mirror_link import MirrorLink
    from mimics_app.contracts.clock import SECOND_NS

    buffer = MirrorBuffer(round(args.delay * SECOND_NS))
    link = MirrorLink(args.url, buffer, args.certificate)
    try:
        with MirrorDisplay(link, buffer, args.scene, args.camera, args.output, args.size) as display:
            shown = display.run(args.seconds)
    finally:
        link.close()
    answer(args, {"frames": shown, "scene": display.scene}, [f"{shown} pictures of {display.scene}"])
    return 0
