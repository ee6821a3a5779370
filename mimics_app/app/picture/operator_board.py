"""The board over the mirror of a headset, for the operator at the window."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.app.picture.board import BoardLayout
from mimics_app.contracts.board import Board
from mimics_app.rendering.visual.figures.key_page import KeyPage
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["OperatorBoard"]


class OperatorBoard:
    """Draws a board over what a surface shows.

    Args:
        surface: Surface with the mirror of the headset.
    """

    def __init__(self, surface: Surface) -> None:
        self._canvas, self._layout = PageSurface(surface), BoardLayout()

    def draw(self, board: Board, show: Sequence[str], force_full: float, page: KeyPage | None) -> None:
        """Draw a board; see `BoardLayout.lay`."""
        self._canvas.fit()
        self._layout.lay(self._canvas.hud, board, show, force_full, page)
        self._canvas.draw(over=True)

    def release(self) -> None:
        """Free everything but the surface."""
        self._canvas.release()
