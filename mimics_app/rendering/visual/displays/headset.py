"""A headset without a runtime: both panels are one monitor, and the lens distortion is corrected here."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.ports.display_port import Composing, Eye, Rect, Size, Viewpoint
from mimics_app.maths.poses import pose_from_parts
from mimics_app.rendering.visual.displays.headset_file import EyeSpec, HeadsetSpec
from mimics_app.rendering.visual.displays.lens import distort
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay
from mimics_app.rendering.visual.view_matrices import Tangents

__all__ = ["RawHeadset", "seen_tangents"]

_EDGE_SAMPLES = 33
"""Samples along each edge of a panel for the bounds of the seen picture."""


class RawHeadset(PlainDisplay):
    """Panels side by side behind lenses; the head pose comes from a tracker, in the frame of the head at rest.

    Args:
        spec: Panels and lenses.
    """

    kind = "hmd"

    def __init__(self, spec: HeadsetSpec) -> None:
        super().__init__()
        self._spec = spec
        self._drawn = [seen_tangents(eye) for eye in (spec.left, spec.right)]
        self.composing = _lens_pass(spec, self._drawn)

    def drawn_size(self, shown: Size) -> Size:
        return shown if self._spec.pixels is None else (2 * self._spec.pixels[0], self._spec.pixels[1])

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        head = self.head(display_ns)
        world_from_head = viewpoint.world_from_rest if head is None else viewpoint.world_from_rest @ head
        return _headset_eyes(self._spec, world_from_head, drawn, self._drawn)


def _headset_eyes(
    spec: HeadsetSpec,
    world_from_head: F8,
    drawn: Size,
    tangents: list[Tangents],
) -> list[Eye]:
    """Return both eyes side by side in a picture, each with its own pose.

    Args:
        spec: The headset.
        world_from_head: Pose of the head, float64 [4, 4].
        drawn: Size of the picture [px].
        tangents: Tangents of each eye's picture.
    """
    half = drawn[0] // 2
    places: list[Rect] = [(0, 0, half, drawn[1]), (half, 0, drawn[0] - half, drawn[1])]
    return [
        Eye(
            name,
            world_from_head @ pose_from_parts(eye.position, eye.rotation),
            tangents[number],
            places[number],
            pair=0,
        )
        for number, (name, eye) in enumerate((("left", spec.left), ("right", spec.right)))
    ]


def seen_tangents(eye: EyeSpec) -> Tangents:
    """Return left, right, bottom, top of the picture to draw: what a panel shows through its lens."""
    left, right, bottom, top = eye.tangents
    across, down = np.linspace(left, right, _EDGE_SAMPLES), np.linspace(bottom, top, _EDGE_SAMPLES)
    edges = [(x, y) for x in across for y in (bottom, top)] + [(x, y) for y in down for x in (left, right)]
    centre = np.array(eye.lens.centre)
    at = np.array(edges) - centre
    seen = np.concatenate([distort(at, k) for k in (eye.lens.red, eye.lens.green, eye.lens.blue)]) + centre
    (x0, y0), (x1, y1) = seen.min(axis=0).tolist(), seen.max(axis=0).tolist()
    return (x0, x1, y0, y1)


def _lens_pass(spec: HeadsetSpec, drawn: list[Tangents]) -> Composing:
    vectors: dict[str, tuple[float, ...]] = {}
    for number, eye in enumerate((spec.left, spec.right)):
        lens = eye.lens
        vectors[f"panel_{number}"] = eye.tangents
        vectors[f"seen_{number}"] = drawn[number]
        vectors[f"lens_{number}"] = (*lens.red, *lens.green, *lens.blue, *lens.centre, 0.0)
    return Composing("display/lens.frag", vectors)
