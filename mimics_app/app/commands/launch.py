"""`mimics` without a command: the launcher, a window that lists the scenes and runs the one chosen."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import DeviceError

if TYPE_CHECKING:
    from mimics_app.app.play.journey import Opening
    from mimics_app.rendering.visual.launcher.launcher import LauncherChoice
    from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["run"]

_POLLS_PER_PICTURE = 6
"""Polls of the waiting page per picture drawn: ten pictures a second leave the processor to the session that starts."""


def run(args: argparse.Namespace) -> int:
    """Show the launcher and play the scenes chosen until the person leaves.

    After a session that could not start, the launcher shows its error.

    Raises:
        DeviceError: there is no display.
    """
    from mimics_app.app.picture.window_opening import remember_size
    from mimics_app.app.play.journey import play_through
    from mimics_app.app.play.launching import remember, settings_of_choice
    from mimics_app.app.terminal.display import has_display

    if not has_display():
        raise DeviceError(
            "the launcher needs a display", "without one: mimics run wavy_tunnel --headless; mimics scenes lists others"
        )
    notice = ""
    while True:
        with ExitStack() as window:
            surface = window.enter_context(_opened_window())
            choice = _choose(surface, notice)
            remember_size(surface)
            if choice is None:
                return 0
            remember(choice)
            ended = play_through(settings_of_choice(choice), _waiting(surface, choice.scene, window))
        notice = ended.error
        if not (ended.other or notice):
            return ended.code


def _opened_window() -> Surface:
    from mimics_app.app.picture.window_opening import open_window

    return open_window(None, "mimics", scene=False)


def _waiting(surface: Surface, scene: Path, window: ExitStack) -> Opening:
    """Return the progress page in the launcher's window, which closes when the session's own window is open."""
    from mimics_app.app.play.journey import Opening
    from mimics_app.app.scenes.shipped import find_shipped
    from mimics_app.rendering.visual.launcher.waiting_page import WaitingPage

    known = find_shipped(scene.stem)
    page: WaitingPage | None = WaitingPage(surface, scene.stem if known is None else known.title)

    class Waiting(Opening):
        looked = 0

        def look(self, doing: str) -> bool:
            if page is None:  # played again: the launcher's window is closed already
                return True
            left = any(event.kind == "key" and event.name == "escape" and event.pressed for event in surface.poll())
            if left or surface.should_close:
                return False
            if self.looked % _POLLS_PER_PICTURE == 0:
                page.draw(doing)
                surface.swap()
            self.looked += 1
            return True

        def shown(self) -> None:
            nonlocal page
            page = None
            window.close()

    return Waiting()


def _choose(surface: Surface, notice: str) -> LauncherChoice | None:
    from mimics_app.app.play.launching import cut_off_notice, last_choice, launcher_cards, launcher_settings
    from mimics_app.contracts.clock import FRAME_NS, MonotonicClock
    from mimics_app.rendering.visual.launcher.launcher import Launcher

    runs = Path("runs")
    clock, cards = MonotonicClock(), launcher_cards(runs)
    launcher = Launcher(surface, cards, launcher_settings(), last_choice(), notice or cut_off_notice(runs))
    try:
        while not surface.should_close and not launcher.left:
            launcher.handle(surface.poll())
            if launcher.choice is not None:
                return launcher.choice
            launcher.draw()
            surface.swap()
            clock.sleep_until_ns(clock.now_ns() + FRAME_NS // 4)
        return None
    finally:
        launcher.release()
