"""The thumbnail on a card of the launcher."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import U1
from mimics_app.contracts.system.regular_file import open_regular

__all__ = ["load_thumbnail"]

_THUMBNAIL = (512, 288)
"""Width and height of a thumbnail [px]."""


def load_thumbnail(file: Path | None) -> U1:
    """Return an image file cropped to 16:9, RGBA uint8 [288, 512, 4]; a plain colour where it cannot be read."""
    from PIL import Image, ImageOps

    if file is not None:
        try:
            with open_regular(file) as stream, Image.open(stream) as picture:
                fitted = ImageOps.fit(picture.convert("RGBA"), _THUMBNAIL, Image.Resampling.LANCZOS)
                return np.array(fitted, np.uint8)
        except OSError:
            pass  # a missing image does not stop the launcher
    width, height = _THUMBNAIL
    return np.full((height, width, 4), (38, 48, 60, 255), np.uint8)
