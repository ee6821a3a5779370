"""Window of the pages before and after the sessions of a person: the launcher's, or that of `mimics run`."""

from __future__ import annotations

import math
from pathlib import Path

from mimics_app.app.picture.window_opening import open_window, remember_size
from mimics_app.app.play.journey import Following, Pages
from mimics_app.app.play.outcome import Origin
from mimics_app.app.play.result_screen import show_result
from mimics_app.contracts.clock import FRAMES_PER_SECOND, MonotonicClock
from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.visual.figures.palette import ACCENT, BACK, FAINT, INK, PANEL_LIT
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.surfaces.surface import Place, Size, Surface

__all__ = ["JourneyWindow"]

_BAR, _RUNNER = 420.0, 110.0
"""Widths of the bar and of the runner on it [hud px]; the duration is unknown, as it depends on the driver."""

_PERIOD_S = 1.6
_MARGIN = 24.0


class WaitingPage:
    """Drawn frame by frame; the caller swaps the surface.

    Args:
        surface: The window.
        title: Title of the scene.
    """

    def __init__(self, surface: Surface, title: str) -> None:
        self._canvas = PageSurface(surface)
        self._title = title
        self._frames = 0

    def draw(self, doing: str, *, leaves: bool = True) -> None:
        """Draw one frame with a description of the present step, and of Escape where it `leaves`."""
        self._canvas.fit()
        hud, centre = self._canvas.hud, 0.5 * self._canvas.hud.height
        x = 0.5 * (hud.width - _BAR)
        hud.clear()
        hud.box(0.0, 0.0, hud.width, hud.height, BACK)
        title, room = translated(self._title), hud.width - 2.0 * _MARGIN
        hud.fitted(0.5 * hud.width, centre + 44.0, title, (14.0, 30.0), room, INK, bold=True, align="centre")
        hud.box(x, centre, _BAR, 8.0, PANEL_LIT, radius=4.0)
        swing = 0.5 - 0.5 * math.cos(2.0 * math.pi * self._frames / (_PERIOD_S * FRAMES_PER_SECOND))
        hud.box(x + swing * (_BAR - _RUNNER), centre, _RUNNER, 8.0, ACCENT, radius=4.0)
        hud.text(0.5 * hud.width, centre - 36.0, translated(doing), 17.0, FAINT, align="centre")
        if leaves:
            hud.text(0.5 * hud.width, 40.0, translated(phrase("Esc: leave")), 14.0, FAINT, align="centre")
        self._canvas.draw()
        self._frames += 1

    def release(self) -> None:
        """Free everything but the surface."""
        self._canvas.release()


_POLLS_PER_PICTURE = 6
"""Polls of the waiting page per picture drawn: ten pictures a second leave the processor to the session that starts."""


class JourneyWindow(Pages):
    """A window that opens when it is first used, and from then on exists until it is closed.

    Args:
        size: Width and height [px]; None: as a person last gave a window, else as suits the monitor.
        origin: Where the page of results leads back to.

    Attributes:
        title: Title of the scene that is waited for.
    """

    def __init__(self, size: Size | None = None, *, origin: Origin) -> None:
        self._size, self.origin, self.title = size, origin, ""
        self._surface: Surface | None = None
        self._page: WaitingPage | None = None
        self._looked = 0

    @property
    def surface(self) -> Surface:
        """The window."""
        if self._surface is None:
            self._surface = open_window(self._size, "mimics", scene=False)
        return self._surface

    @property
    def closed(self) -> bool:
        """Whether the person closed the window."""
        return self._surface is not None and self._surface.should_close

    def wait(self, doing: str, *, leaves: bool) -> bool:
        """Show the present step; Escape and the window's cross end the wait where `leaves`."""
        surface = self.surface
        escaped = any(event.kind == "key" and event.name == "escape" and event.pressed for event in surface.poll())
        if leaves and (escaped or surface.should_close):
            return False
        if self._looked % _POLLS_PER_PICTURE == 0:
            if self._page is None:
                self._page = WaitingPage(surface, self.title)
            self._page.draw(doing, leaves=leaves)
            surface.swap()
        self._looked += 1
        return True

    def place(self) -> list[int]:
        place = self.surface.place
        return [] if place is None else [int(value) for value in place]

    def hide(self) -> None:
        self._end_page()
        remember_size(self.surface)
        self.surface.hide()

    def show(self, place: list[int]) -> None:
        if place:
            self.surface.move_to(Place.of(place))
        self._looked = 0
        self.surface.show()

    def result(self, folder: Path) -> Following:
        self._end_page()
        return show_result(self.surface, folder, MonotonicClock(), origin=self.origin)

    def close(self) -> None:
        """Close the window, if it was opened."""
        self._end_page()
        if self._surface is not None:
            remember_size(self._surface)
            self._surface.close()
            self._surface = None

    def __enter__(self) -> JourneyWindow:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _end_page(self) -> None:
        if self._page is not None:
            self._page.release()
            self._page = None
