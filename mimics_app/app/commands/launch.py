"""`mimics` without a command: the launcher, a window that lists the scenes and runs the one chosen."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import DeviceError, MimicsError, first_line

if TYPE_CHECKING:
    from mimics_app.app.play.journey import JourneyEnd
    from mimics_app.app.play.journey_window import JourneyWindow
    from mimics_app.app.settings import RunSettings
    from mimics_app.rendering.visual.launcher.launcher import LauncherChoice
    from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["launch_in", "run"]

_RUNS = Path("runs")


def run(args: argparse.Namespace) -> int:
    """Show the launcher and play the scenes chosen until the person leaves.

    Raises:
        DeviceError: the window cannot open.
    """
    from mimics_app.app.terminal.display import has_display

    if not has_display():
        raise DeviceError(
            "the launcher needs a display", "without one: mimics run wavy_tunnel --headless; mimics scenes lists others"
        )
    from mimics_app.rendering.visual.surfaces.screen_check import check_screen

    check_screen()
    from mimics_app.app.play.journey_window import JourneyWindow

    with JourneyWindow(origin="launcher") as window:
        return launch_in(window)


def launch_in(window: JourneyWindow) -> int:
    """Show the launcher in a window, and play the scenes chosen in it until the person leaves.

    After a session that could not start, the launcher shows its error.
    """
    from mimics_app.app.play.launching import remember

    notice = ""
    while True:
        window.origin = "launcher"
        choice = _choose(window.surface, notice)
        if choice is None:
            return 0
        if choice.run is None:
            remember(choice)
        if choice.people:
            from mimics_app.app.study.people_screen import show_people

            window.origin, notice = "participant", ""
            show_people(window, choice)
            continue
        ended = _follow(choice, window)
        if ended.following == "close":
            return ended.code
        notice = ended.error


def _follow(choice: LauncherChoice, window: JourneyWindow) -> JourneyEnd:
    """Show the result of an earlier session, or play a scene."""
    from mimics_app.app.play.journey import JourneyEnd, play_through
    from mimics_app.app.play.launching import settings_of_choice
    from mimics_app.app.scenes.shipped import find_shipped

    known = find_shipped(choice.scene.stem)
    window.title = choice.scene.stem if known is None else known.title
    if choice.run is not None:
        following = window.result(choice.run)
        if following != "again":
            return JourneyEnd(0, following)
    settings, missing = settings_of_choice(choice), ""
    try:
        why = _why_not_sided(settings)
        if settings.participant and not why:
            from mimics_app.app.study.studies import body_of_code, fit_of_code

            body = body_of_code(settings.participant, _RUNS, settings.scene)
            settings = replace(settings, fit=fit_of_code(settings.participant, _RUNS), avatar=body.file)
            missing = body.why_not
    except (MimicsError, OSError) as error:  # of a file: nobody plays what should have been fitted, and was not
        why = first_line(error)
    if why:
        return JourneyEnd(0, "other", why)
    if settings.console is not None:
        from mimics_app.app.play.operators_page import open_page

        open_page(settings.console)
    ended = play_through(settings, window)
    return replace(ended, error=ended.error or missing)


def _why_not_sided(settings: RunSettings) -> str:
    """Return why a scene cannot be played on the left side, in words; "" where it can, or need not."""
    if settings.side == "right":
        return ""
    from mimics_app.app.scenes.loading import read_scene
    from mimics_app.app.scenes.mirrored_scene import why_not_mirrored
    from mimics_app.contracts.system.phrases import phrase

    why = why_not_mirrored(read_scene(settings.scene).document)
    return why and phrase('This scene is not played on the left side: {why}. Choose "right side"', why=why)


def _choose(surface: Surface, notice: str) -> LauncherChoice | None:
    from mimics_app.app.play.launching import (
        LANGUAGE,
        cut_off_notice,
        last_choice,
        launcher_cards,
        launcher_settings,
        wants_contrast,
    )
    from mimics_app.contracts.clock import FRAME_NS, MonotonicClock
    from mimics_app.contracts.system.language import speak
    from mimics_app.rendering.visual.figures.contrast import use_high_contrast
    from mimics_app.rendering.visual.launcher.launcher import Launcher

    clock, cards = MonotonicClock(), launcher_cards(_RUNS)
    launcher = Launcher(surface, cards, launcher_settings(), last_choice(), notice or cut_off_notice(_RUNS))
    surface.poll()  # discard keys that were pressed before the page was visible
    try:
        while not surface.should_close and not launcher.left:
            launcher.handle(surface.poll())
            speak(launcher.values[LANGUAGE])
            use_high_contrast(wants_contrast(launcher.values))
            if launcher.choice is not None:
                return launcher.choice
            launcher.draw()
            surface.swap()
            clock.sleep_until_ns(clock.now_ns() + FRAME_NS // 4)
        return None
    finally:
        launcher.release()
