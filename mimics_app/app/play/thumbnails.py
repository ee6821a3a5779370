"""Thumbnails of the shipped scenes for the launcher: each scene is played for a moment and drawn without its board."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from mimics_app.app.play.stills import draw_stills
from mimics_app.app.scenes.shipped import ShippedScene, shipped_scenes
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import UsageError, nearest

__all__ = ["draw_sheet", "draw_thumbnails"]

_DRAWN, _KEPT = (1024, 576), (512, 288)
"""Size as drawn, and as saved [px]; the reduction smooths edges."""

_JPEG_QUALITY = 86
_COLUMNS = 4
"""Number of pictures in a row of the contact sheet."""

_MOMENT_S = 1.5
_MOMENTS_S = {
    "wavy_tunnel": 2.0,
    "pick_and_place": 3.0,
    "guided_walk": 4.0,
    "city_walk": 9.0,
    "canyon_walk": 18.0,
    "soccer": 5.0,
    "calibration": 7.0,
    "falling_pairs": 0.5,
    "tower": 0.3,
}
"""Time for which the simulated patient plays before the picture is drawn [s], by scene."""


def draw_thumbnails(folder: Path, names: Sequence[str] = ()) -> Iterator[Path]:
    """Write NAME.jpg of each scene into a folder; yield each file when it is written.

    Args:
        folder: Folder of the files; created if missing.
        names: Names of scenes; () for all shipped ones.

    Raises:
        UsageError: There is no shipped scene of a name.
    """
    scenes = {scene.name: scene for scene in shipped_scenes()}
    for name in names:
        if name not in scenes:
            raise UsageError(f'no shipped scene is called "{name}"', nearest(name, scenes))
    folder.mkdir(parents=True, exist_ok=True)
    for scene in [scenes[name] for name in names] or scenes.values():
        yield _draw(scene, folder)


def draw_sheet(files: Sequence[Path], sheet: Path) -> None:
    """Write a contact sheet of pictures of scenes, each with its title."""
    from PIL import Image, ImageDraw, ImageFont

    titles = {scene.name: scene.title for scene in shipped_scenes()}
    (width, height), gap, line = _KEPT, 12, 34
    rows = -(-len(files) // _COLUMNS)
    whole = Image.new("RGB", (_COLUMNS * (width + gap) + gap, rows * (height + gap + line) + gap), (14, 18, 24))
    pen, font = ImageDraw.Draw(whole), ImageFont.load_default(22)
    for number, file in enumerate(files):
        x, y = gap + number % _COLUMNS * (width + gap), gap + number // _COLUMNS * (height + gap + line)
        with Image.open(file) as picture:
            whole.paste(picture, (x, y))
        pen.text((x + 4, y + height + 6), titles[file.stem], fill=(240, 243, 247), font=font)
    whole.save(sheet, quality=_JPEG_QUALITY, optimize=True)


def _draw(scene: ShippedScene, folder: Path) -> Path:
    from PIL import Image

    with tempfile.TemporaryDirectory() as place:
        drawn = draw_stills(
            RunSettings(scene.file, size=_DRAWN, quality="full"),
            Path(place),
            seconds=_MOMENTS_S.get(scene.name, _MOMENT_S),
            board=False,
        )
        file = folder / f"{scene.name}.jpg"
        with Image.open(drawn.files[0]) as picture:
            small = picture.convert("RGB").resize(_KEPT, Image.Resampling.LANCZOS)
        small.save(file, quality=_JPEG_QUALITY, optimize=True)
    return file
