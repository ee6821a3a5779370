"""Windows for the single pictures of a display, beside the surface that shows all of them."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.contracts.ports.display_port import Display, Eye
from mimics_app.rendering.visual.presenting.compose import ComposePass
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.surfaces.wall_windows import WallWindows

__all__ = ["BesideWindows"]


class BesideWindows:
    """The windows of a display's pictures, opened with the first frame.

    Args:
        display: Display that lists the windows.
        surface: Surface whose context they share.
    """

    def __init__(self, display: Display, surface: Surface) -> None:
        self._display, self._surface = display, surface
        self._windows: WallWindows | None = None
        self._composed: EyeBuffer | None = None
        self._opened = False
        self._faults: list[str] = []

    def show(self, drawn: EyeBuffer, eyes: Sequence[Eye], compose: ComposePass | None) -> None:
        """Show each eye's picture in its window.

        Args:
            drawn: Picture of all eyes.
            eyes: The eyes as drawn.
            compose: Composition of the display, None without one.
        """
        windows = self._open(eyes[0].rectangle[2:])
        if windows is None:
            return
        whole = drawn
        if compose is not None:
            whole = self._composed = self._composed or EyeBuffer(self._surface, drawn.size)
            whole.resize(drawn.size)
            compose.draw(drawn, whole, [eye.rectangle for eye in eyes])
        windows.show(whole.texture.glo, [(eye.name, eye.rectangle) for eye in eyes])

    @property
    def should_close(self) -> bool:
        """Whether the person closed one of them."""
        return self._windows is not None and self._windows.should_close

    def take_faults(self) -> list[str]:
        """Return the windows that could not be opened, a line each; each is reported once."""
        taken, self._faults = self._faults, []
        return taken

    def close(self) -> None:
        """Close the windows; the next frame opens them again."""
        if self._windows is not None:
            self._windows.close()
        self._windows, self._composed, self._opened = None, None, False

    def _open(self, size: tuple[int, int]) -> WallWindows | None:
        if self._opened:
            return self._windows
        self._opened = True
        self._windows = self._surface.open_beside(self._display.windows, size)
        if self._windows is not None and self._windows.missing:
            names = ", ".join(self._windows.missing)
            self._faults.append(f'no monitor is left for {names}: seen in the first window alone; give a wall "window"')
        return self._windows
