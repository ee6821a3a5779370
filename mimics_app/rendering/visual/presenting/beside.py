"""Pictures that have windows of their own, beside the surface that shows all of them."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.contracts.display_port import Display, Eye
from mimics_app.rendering.visual.presenting.compose import ComposePass
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.surfaces.wall_windows import WallWindows

__all__ = ["BesideWindows"]


class BesideWindows:
    """The windows of a display's pictures; opened when the first frame is shown.

    Args:
        display: Says which there are.
        surface: In whose context everything is drawn.
    """

    def __init__(self, display: Display, surface: Surface) -> None:
        self._display, self._surface = display, surface
        self._windows: WallWindows | None = None
        self._composed: EyeBuffer | None = None
        self._begun = False
        self._faults: list[str] = []

    def show(self, drawn: EyeBuffer, eyes: Sequence[Eye], compose: ComposePass | None) -> None:
        """Bring each eye's picture to its window.

        Args:
            drawn: All eyes.
            eyes: As they were drawn.
            compose: What a display lays over its pictures, None for nothing.
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
        """What could not be opened, a line each, once."""
        taken, self._faults = self._faults, []
        return taken

    def close(self) -> None:
        """Close them; the next frame opens them again."""
        if self._windows is not None:
            self._windows.close()
        self._windows, self._composed, self._begun = None, None, False

    def _open(self, size: tuple[int, int]) -> WallWindows | None:
        if self._begun:
            return self._windows
        self._begun = True
        self._windows = self._surface.open_beside(self._display.windows, size)
        if self._windows is not None and self._windows.missing:
            names = ", ".join(self._windows.missing)
            self._faults.append(f'no monitor is left for {names}: seen in the first window alone; give a wall "window"')
        return self._windows
