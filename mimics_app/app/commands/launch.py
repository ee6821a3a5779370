"""`mimics` alone: a window that lists the scenarios with picture and settings, and runs the one chosen."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import DeviceError

if TYPE_CHECKING:
    from mimics_app.app.play.journey import Opening
    from mimics_app.app.settings import RunSettings
    from mimics_app.rendering.visual.launcher.launcher import ScenarioCard
    from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["run"]

_SIZE = (1280, 720)

_OWN = "scene's own"
_WORDS = {"pointer": "mouse, keys, gamepad", "simulated_hapticmaster": "simulated patient"}
"""Devices in a person's words; plug-ins are called by their names."""


def run(args: argparse.Namespace) -> int:
    """Show the launcher, play what is chosen, and come back to it until the person leaves.

    Raises:
        DeviceError: there is no display.
    """
    from mimics_app.app.play.journey import play_through
    from mimics_app.app.play.play import play
    from mimics_app.app.terminal.display import has_display

    if not has_display():
        raise DeviceError("the launcher needs a display", "try: mimics run scenes/wavy_tunnel.json")
    while True:
        with ExitStack() as window:
            surface = window.enter_context(_opened_window())
            choice = _choose(surface)
            if choice is None:
                return 0
            settings = _settings(*choice)
            if settings.headless:
                return play(settings, as_json=args.json)
            code, other = play_through(settings, _waiting(surface, choice[0], window))
        if not other:
            return code


def _settings(scene: Path, options: Mapping[str, str]) -> RunSettings:
    """What the person chose, as the settings of a run."""
    from mimics_app.app.settings import RunSettings

    headless = options["display"] == "headless"
    patient = options["patient"]
    return RunSettings(
        scene=scene,
        headless=headless,
        profile=options["profile"],  # type: ignore[arg-type]
        device="" if headless else next((d for d, w in _WORDS.items() if w == options["device"]), options["device"]),
        patient="" if patient == _OWN else patient,
    )


def _opened_window() -> Surface:
    from mimics_app.rendering.visual.surfaces.contexts import create_surface

    return create_surface("window", _SIZE, "mimics")


def _waiting(surface: Surface, scene: Path, window: ExitStack) -> Opening:
    """Shows on the launcher's window what the start of a session is doing, and closes it for the session's own."""
    from mimics_app.app.play.journey import Opening
    from mimics_app.rendering.visual.launcher.waiting_page import WaitingPage

    page: WaitingPage | None = WaitingPage(surface, _title(scene))

    class Waiting(Opening):
        def look(self, doing: str) -> bool:
            if page is None:  # played again: the session before has had the window closed
                return True
            left = any(event.kind == "key" and event.name == "escape" and event.pressed for event in surface.poll())
            if left or surface.should_close:
                return False
            page.draw(doing)
            surface.swap()
            return True

        def shown(self) -> None:
            nonlocal page
            page = None
            window.close()

    return Waiting()


def _options() -> dict[str, list[str]]:
    """Settings of the launcher: what is installed here."""
    from mimics_app.rendering.haptic.devices.device_names import device_names

    devices = [_WORDS.get(name, name) for name in ("pointer", *device_names()) if name != "replay"]
    return {
        "profile": ["training", "draft", "study"],
        "device": list(dict.fromkeys(devices)),
        "display": ["window", "headless"],
        "patient": [_OWN, "healthy", "moderate", "severe"],
    }


def _choose(surface: Surface) -> tuple[Path, dict[str, str]] | None:
    from mimics_app.contracts.clock import FRAME_NS, MonotonicClock
    from mimics_app.rendering.visual.launcher.launcher import Launcher

    clock, launcher = MonotonicClock(), Launcher(surface, _cards(), _options())
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


def _cards() -> list[ScenarioCard]:
    """One card per shipped scene that is played, scenarios first: its title, words, and picture where it has one."""
    from mimics_app.app.scenes.catalogue import ONLY_LOOKED_AT
    from mimics_app.contracts.resources import root
    from mimics_app.rendering.visual.launcher.launcher import ScenarioCard

    cards = []
    folder = root() / "scenes"
    for scene in [*sorted(folder.glob("*.json")), *sorted((folder / "examples").glob("*.json"))]:
        document = json.loads(scene.read_text(encoding="utf-8"))
        if document.get("scenario") == ONLY_LOOKED_AT:
            continue
        cards.append(
            ScenarioCard(
                title=document.get("title", scene.stem),
                description=document.get("description", ""),
                picture=_picture(document.get("picture", ""), folder),
                scene=scene,
            )
        )
    return cards


def _title(scene: Path) -> str:
    return str(json.loads(scene.read_text(encoding="utf-8")).get("title", scene.stem))


def _picture(uri: str, folder: Path) -> Path | None:
    """The picture a scene names, None where it is not there."""
    from mimics_app.world.scene.paths import PathFault, find_file

    try:
        return find_file(uri, folder, folder.parent)
    except PathFault:
        return None
