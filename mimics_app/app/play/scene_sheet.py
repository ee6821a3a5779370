"""Contact sheet of scenes, and their exposure: shares of black and white pixels, light left in shadows."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.app.play.stills import draw_stills
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.arrays import U1
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.maths.colour import linear_light
from mimics_app.rendering.visual.effects.captions import caption_picture
from mimics_app.rendering.visual.lighting import gather_lighting
from mimics_app.world.components.visible import Environment
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.scene import Scene

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["SceneLight", "draw_scene_sheet", "light_rows", "measure_light", "scenes_in", "shade_share"]


_DRAWN = (640, 360)
_TILE = (320, 180)
"""Size of a scene as drawn, and on the sheet [px]."""
_COLUMNS = 5
_GAP = 4
_GROUND = (238, 238, 234)
_NAME = 18
"""Height of a name on a tile [px]."""
_QUALITY = 84
"""Quality of the JPEG file, 0 to 100."""
_SECONDS = 2.0
"""Time for which the scene is played before it is drawn [s]."""
_DARK, _BRIGHT = 0.05, 0.98
"""Usable range of linear luminance: darker pixels lose shapes, brighter ones colours."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear RGB in the luminance (ITU-R BT.709)."""


@dataclass(frozen=True, slots=True)
class SceneLight:
    """Exposure of one scene of a sheet.

    Attributes:
        scene: Name of its file without suffix.
        dark: Share of pixels below 5 % of the linear range.
        bright: Share of pixels above 98 %.
        shade: Illumination of level ground in the sun's shadow over that beside it; None where no sun casts a shadow.
        night: Whether the scene is marked as dark.
    """

    scene: str
    dark: float
    bright: float
    shade: float | None
    night: bool


def scenes_in(folder: Path) -> list[Path]:
    """Return the scenes in a folder and its subfolders except `parts`, by name.

    Raises:
        SceneError: There is none.
    """
    found = [file for file in sorted(folder.rglob("*.json")) if file.parent.name != "parts" and _is_scene(file)]
    if not found:
        raise SceneError(Issue(str(folder), "", "holds no scene", "name a folder with scene files, such as scenes"))
    return found


def draw_scene_sheet(files: Sequence[Path], output: Path, *, backend: str = "auto") -> list[SceneLight]:
    """Draw scenes, without their boards, onto one picture; return their exposure.

    Args:
        files: Scene files in reading order.
        output: The picture, .jpg or .png.
        backend: "auto", "egl", "osmesa" or "window".

    Raises:
        SceneError: A scene is faulty, or has no camera.
        DeviceError: The OpenGL context is not available.
    """
    from PIL import Image

    rows = -(-len(files) // _COLUMNS)
    wide, high = (side + _GAP for side in _TILE)
    sheet = Image.new("RGB", (_COLUMNS * wide + _GAP, rows * high + _GAP), _GROUND)
    lights = []
    for number, file in enumerate(files):
        pixels = _drawn(file, backend)
        lights.append(measure_light(file, pixels))
        tile = Image.fromarray(pixels).resize(_TILE, Image.Resampling.LANCZOS)
        _name(tile, file.stem.replace("_", " "))
        sheet.paste(tile, (_GAP + number % _COLUMNS * wide, _GAP + number // _COLUMNS * high))
    output.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(output, quality=_QUALITY, optimize=True)
    return lights


def measure_light(file: Path, pixels: U1) -> SceneLight:
    """Return the exposure of a scene from its picture without a board, display values [height, width, 3]."""
    scene = load_scene(file)
    luminance = linear_light(pixels / 255.0) @ _LUMINANCE
    night = (scene.first(Environment) or Environment()).night
    dark, bright = float((luminance < _DARK).mean()), float((luminance > _BRIGHT).mean())
    return SceneLight(file.stem, dark, bright, shade_share(scene), night)


def shade_share(scene: Scene) -> float | None:
    """Return the illumination of level ground in the sun's shadow over that beside it; None without a sun's shadow."""
    lighting = gather_lighting(build_world(scene))
    sun = float(lighting.sun_colour @ _LUMINANCE) * max(float(lighting.sun_direction[1]), 0.0)
    shade = float(lighting.sky_light().sum(axis=0) @ _LUMINANCE)
    return shade / (sun + shade) if lighting.sun_casts_shadow and sun > 0.0 else None


def light_rows(lights: Sequence[SceneLight]) -> list[dict[str, object]]:
    """Return the exposures as objects for JSON, shares rounded to a thousandth."""
    return [
        {key: round(value, 3) if isinstance(value, float) else value for key, value in asdict(light).items()}
        for light in lights
    ]


def _is_scene(file: Path) -> bool:
    """Whether a path is a JSON file with the format of a scene."""
    try:
        head = json.loads(read_regular(file))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(head, dict) and head.get("format") == "mimics-scene"


def _drawn(file: Path, backend: str) -> U1:
    from PIL import Image

    settings = RunSettings(file, size=_DRAWN)
    with tempfile.TemporaryDirectory() as folder:
        drawn = draw_stills(settings, Path(folder), backend=backend, seconds=_SECONDS, board=False)
        with Image.open(drawn.files[-1]) as picture:
            return np.array(picture.convert("RGB"))


def _name(tile: Image.Image, text: str) -> None:
    """Write a scene's name into the lower left corner of its tile."""
    from PIL import Image

    wide = round(_NAME * (0.7 + 0.36 * len(text)))
    plate = Image.fromarray(caption_picture(text, (float(wide), float(_NAME))).pixels).resize((wide, _NAME))
    tile.paste(plate, (5, tile.height - _NAME - 5), plate)
