"""Stereo on one screen: off-axis frusta through a common window, never toed in, and ways to show both eyes."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.ports.display_port import Composing, Eye, Rect, Size, Viewpoint
from mimics_app.rendering.visual.displays.desktop import compute_window_tangents
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay, eye_offset
from mimics_app.rendering.visual.view_matrices import Tangents

__all__ = ["DUBOIS_RED_CYAN", "STEREO_KINDS", "StereoDisplay"]

STEREO_KINDS = ("sbs", "sbs-half", "tb", "interleaved", "anaglyph", "quad")

DUBOIS_RED_CYAN = np.array(
    [
        [0.456, 0.500, 0.176, -0.043, -0.088, -0.002],
        [-0.040, -0.038, -0.016, 0.378, 0.734, -0.018],
        [-0.015, -0.021, -0.005, -0.072, -0.113, 1.226],
    ]
)
"""Least-squares matrix for red-cyan glasses, from and to linear light: columns are RGB of the left, then of the right
eye (Dubois 2001, "A projection method to generate anaglyph stereo images")."""


class StereoDisplay(PlainDisplay):
    """Both eyes of a person in front of a flat screen.

    Args:
        kind: One of `STEREO_KINDS`. "sbs": side by side, each eye with the aspect ratio of its half; "sbs-half": the
            same, each squeezed to half the width; "tb": left on top, squeezed to half the height; "interleaved": even
            rows left, counted from the top; "anaglyph": red-cyan glasses; "quad": quad buffers.
        ipd: Interpupillary distance [m].
        screen_distance: Distance of zero parallax [m].
        swap: True swaps left and right, for cross-eyed viewing and for displays wired in reverse.
    """

    def __init__(self, kind: str, ipd: float = 0.063, screen_distance: float = 2.0, *, swap: bool = False) -> None:
        super().__init__()
        self.kind = kind
        self._ipd, self._distance, self._swap = ipd, screen_distance, swap
        self._whole = kind in ("interleaved", "anaglyph", "quad")
        self.composing = _composing(kind)

    def drawn_size(self, shown: Size) -> Size:
        # Where both eyes have full resolution they are drawn side by side before composition.
        return (2 * shown[0], shown[1]) if self._whole else shown

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        first, second = self._rectangles(drawn)
        proportions = {"sbs-half": drawn, "tb": drawn}.get(self.kind, first[2:])
        window = compute_window_tangents(viewpoint.vertical_fov, (proportions[0], proportions[1]))
        places = (second, first) if self._swap else (first, second)
        named = zip(("left", "right"), (-0.5, 0.5), places, strict=True)
        return [self._eye(name, side * self._ipd, window, place, viewpoint) for name, side, place in named]

    def _eye(self, name: str, x: float, window: Tangents, place: Rect, viewpoint: Viewpoint) -> Eye:
        left, right, bottom, top = window
        shift = x / self._distance
        tangents = (left - shift, right - shift, bottom, top)
        return Eye(name, viewpoint.world_from_head @ eye_offset(x), tangents, place, pair=0)

    def _rectangles(self, drawn: Size) -> tuple[Rect, Rect]:
        width, height = drawn
        if self.kind == "tb":
            return (0, height - height // 2, width, height // 2), (0, 0, width, height - height // 2)
        return (0, 0, width // 2, height), (width // 2, 0, width - width // 2, height)


def _composing(kind: str) -> Composing | None:
    if kind == "interleaved":
        return Composing("display/interleaved.frag", {})
    if kind == "anaglyph":
        left, right = DUBOIS_RED_CYAN[:, :3], DUBOIS_RED_CYAN[:, 3:]
        return Composing("display/anaglyph.frag", {"from_left": _flat(left), "from_right": _flat(right)})
    return None


def _flat(matrix: F8) -> tuple[float, ...]:
    return tuple(float(value) for value in matrix.T.ravel())
