"""Window of the pages before and after the sessions of a person: the launcher's, or that of `mimics run`."""

from __future__ import annotations

from pathlib import Path

from mimics_app.app.picture.window_opening import open_window, remember_size
from mimics_app.app.play.journey import Following, Pages
from mimics_app.app.play.result_screen import show_result
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.rendering.visual.launcher.waiting_page import WaitingPage
from mimics_app.rendering.visual.surfaces.surface import Place, Size, Surface

__all__ = ["JourneyWindow"]

_POLLS_PER_PICTURE = 6
"""Polls of the waiting page per picture drawn: ten pictures a second leave the processor to the session that starts."""


class JourneyWindow(Pages):
    """A window that opens when it is first used, and from then on exists until it is closed.

    Args:
        size: Width and height [px]; None: as a person last gave a window, else as suits the monitor.
        from_launcher: Whether a session that ends leads back to the launcher.

    Attributes:
        title: Title of the scene that is waited for.
    """

    def __init__(self, size: Size | None = None, *, from_launcher: bool) -> None:
        self._size, self.from_launcher, self.title = size, from_launcher, ""
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
        return show_result(self.surface, folder, MonotonicClock(), from_launcher=self.from_launcher)

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
