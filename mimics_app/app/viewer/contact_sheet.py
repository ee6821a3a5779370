"""Contact sheet of models: one tile each; a model that cannot be shown is a tile with the reason."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.app.viewer.page import draw_caption, draw_reason
from mimics_app.app.viewer.shown import MODEL_SUFFIXES, Shown, open_shown
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.arrays import U1
from mimics_app.contracts.errors import Issue, SceneError, UsageError
from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels, write_png
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.world import World

__all__ = ["Sheet", "Tile", "draw_models", "draw_sheet"]


TILE = (400, 300)
"""Size of a tile [px]."""

_GAP = 6
_GROUND = (22, 24, 28)
_WALL = (0.035, 0.035, 0.042)
"""Background of a tile with a reason, linear RGB."""
_MOST_TILES = 1000
_MOST_NOTES = 3
"""Largest number of notes that are reported as the reason why nothing is visible."""
_SCALE = 1.8
"""Factor on the font size of a tile."""
_RAISED, _BACK = 0.11, -1.9
"""Shift of a model above its caption [tiles], and of the camera backwards [steps of the wheel]."""


@dataclass(frozen=True, slots=True)
class Tile:
    """One model of a sheet: its file, the reasons why it is not shown ([] for none), and whether it is empty."""

    file: Path
    issues: list[Issue]
    empty: bool = False

    @property
    def shown(self) -> bool:
        """Whether the model itself is on the sheet."""
        return not self.issues


@dataclass(frozen=True, slots=True)
class Sheet:
    """Result of drawing a sheet: the file, its tiles in reading order, backend and driver."""

    file: Path
    tiles: list[Tile]
    backend: str
    gl: str


def _models_in(folder: Path) -> list[Path]:
    """Return the models in a folder and its subfolders, by name.

    Raises:
        SceneError: The path is no folder, or has no model.
    """
    if not folder.is_dir():
        raise SceneError(Issue(str(folder), "", "is not a folder"))
    found = sorted(file for file in folder.rglob("*") if file.suffix.lower() in MODEL_SUFFIXES and file.is_file())
    if not found:
        raise SceneError(Issue(str(folder), "", "holds no model", f"known: {', '.join(MODEL_SUFFIXES)}"))
    return found


def draw_sheet(folder: Path, output: Path, *, backend: str = "auto") -> Sheet:
    """Draw every model of a folder onto one PNG; one that is faulty or empty is a tile with the reason.

    Args:
        folder: Folder of the models.
        output: The PNG file.
        backend: "auto", "egl", "osmesa" or "window".

    Raises:
        SceneError: The folder has no model.
        UsageError: It has too many models for a sheet.
        DeviceError: The OpenGL context is not available.
    """
    return draw_models(_models_in(folder), output, backend=backend)


def draw_models(models: Sequence[Path], output: Path, *, sides: int = 1, backend: str = "auto") -> Sheet:
    """Draw models onto one PNG; with several sides each model is a row of views from equally spaced directions.

    Raises:
        UsageError: There are too many models for a sheet.
        DeviceError: The OpenGL context is not available.
    """
    if len(models) * sides > _MOST_TILES:
        raise UsageError(f"too many models: {len(models)}; at most {_MOST_TILES}", "name a folder below it")
    output.parent.mkdir(parents=True, exist_ok=True)
    surface = open_offscreen(backend, TILE)
    renderer = _TileRenderer(surface)
    tiles, pictures = [], []
    for file in models:
        for side in range(sides):
            tile = renderer.draw(file, 2.0 * math.pi * side / sides)
            pictures.append(read_pixels(surface)[..., :3])
        tiles.append(tile)
    sheet = Sheet(output, tiles, surface.backend, surface.driver)
    renderer.release()
    surface.close()
    write_png(_laid_out(pictures, sides), output)
    return sheet


class _TileRenderer:
    """Draws the tiles one after the other on one surface."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self._viewport: Viewport | None = None
        wall = World()
        wall.environment = Sky(_WALL, _WALL, _WALL, 0.0)
        self._wall = Renderer(surface, wall, RenderSettings(msaa=0, shadow_size=0, fog_density=0.0))

    def draw(self, file: Path, rotation: float) -> Tile:
        """Draw a model rotated about the vertical [rad], or the reason why it cannot be drawn."""
        try:
            shown = open_shown(file)
        except SceneError as error:
            self._draw_reason(file.name, "cannot be shown", error.issues)
            return Tile(file, error.issues)
        if shown.extent is None:
            why = "; ".join(shown.notes[:_MOST_NOTES]) or "no mesh is visible in its scene"
            nothing = [Issue(str(file), "", f"nothing to see: {why}")]
            self._draw_reason(file.name, "nothing to see", [Issue("", "", why)])
            return Tile(file, nothing, empty=True)
        viewport = self._put_on(shown)
        viewport.orbit.yaw += rotation
        viewport.orbit.pan(0.0, _RAISED * TILE[1], TILE)
        viewport.orbit.zoom(_BACK)
        hud = viewport.renderer.hud
        hud.clear()
        hud.fit(TILE)
        draw_caption(hud, file.name, [shown.size], shown.notes[:1], scale=_SCALE)
        viewport.draw_finished()
        return Tile(file, [])

    def release(self) -> None:
        """Free everything but the surface."""
        self._wall.release()
        if self._viewport is not None:
            self._viewport.release()

    def _put_on(self, shown: Shown) -> Viewport:
        if self._viewport is None:
            self._viewport = Viewport(self._surface, shown)
        else:
            self._viewport.show(shown)
            self._viewport.reset()
        return self._viewport

    def _draw_reason(self, name: str, verdict: str, issues: Sequence[Issue]) -> None:
        hud = self._wall.hud
        hud.clear()
        hud.fit(TILE)
        draw_reason(hud, name, verdict, issues, _SCALE)
        self._wall.draw_finished([View(np.eye(4), compute_tangents(1.0, TILE), (0, 0, *TILE))])


def _laid_out(pictures: Sequence[U1], sides: int) -> U1:
    """Return the sheet with the tiles in rows: one model per row with several sides, else about 3:2 in all."""
    width, height = TILE
    columns = (
        min(len(pictures), max(1, round(math.sqrt(1.5 * len(pictures) * height / width)))) if sides == 1 else sides
    )
    rows = -(-len(pictures) // columns)
    sheet = np.empty((rows * (height + _GAP) + _GAP, columns * (width + _GAP) + _GAP, 3), np.uint8)
    sheet[:] = _GROUND
    for number, picture in enumerate(pictures):
        top = _GAP + (number // columns) * (height + _GAP)
        left = _GAP + (number % columns) * (width + _GAP)
        sheet[top : top + height, left : left + width] = picture
    return sheet
