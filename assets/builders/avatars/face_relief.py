"""Relief of a face for its textures: slopes and shade of the modelled shape that its few triangles do not have."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assets.builders.avatars.draft import openness
from assets.builders.avatars.face_map import turns_of
from assets.builders.avatars.face_shape import Head
from assets.builders.avatars.fields import F8, gradient, step
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.sheet import I8
from assets.builders.avatars.textures import place_map

__all__ = ["Relief", "face_relief"]

_BATCH = 8192
"""Points of one evaluation of the field: their arrays stay in the processor's cache."""
_TRUSTED, _STRANGE = 0.0006, 0.0016
"""Distances of a triangle from the modelled shape [m] up to which its slopes count, and from which they do not."""
_STEEPEST = 1.3
"""Largest slope in the normal map."""
_DARKENED = 0.75
"""Share of the shape's shade that is painted."""
_CHIN = (-1.0, -0.78)
"""Elevations [rad] between which the relief fades out under the chin: the triangles of the neck are long."""
_FADE = 3
"""Half of the zone in which the relief fades out at its edges [texel]."""
_SEEN = (1.75, -1.12, 0.80)
"""Largest azimuth to both sides, lowest and highest elevation with relief [rad]: hair and collar hide the rest."""


@dataclass(frozen=True)
class Relief:
    """Relief of every texel of the head's texture.

    Attributes:
        slopes: Of the form against the triangles, along u and against v, [height, width, 2].
        open: Share of the sky that the form lets in, over that of the corners' colours, [height, width].
    """

    slopes: F8
    open: F8


def face_relief(head: Head, skin: Piece, triangles: I8, sheet: F8) -> Relief:
    """Compare the triangles with the shape they approximate.

    Args:
        head: The shape.
        skin: The mesh.
        triangles: Those of the outside of the face, [m, 3].
        sheet: Position of each texel [m], [height, width, 3].
    """
    height, width = sheet.shape[:2]
    flat = sheet.reshape(-1, 3)
    more, _ = place_map(skin.uvs, triangles, np.hstack([skin.normals, skin.shades[:, :1]]), (width, height))
    normals = more.reshape(-1, 4)[:, :3]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-9)[:, None]
    right = np.tile(np.arange(width) < width // 2, height)  # the other half is the same in a mirror
    asked = np.flatnonzero(_seen(head, flat) & right)
    form, open_, trust = _form(head, flat[asked], normals[asked])
    along, down = (np.gradient(sheet, axis=axis).reshape(-1, 3)[asked] for axis in (1, 0))
    counts = np.zeros(len(flat))
    counts[asked] = trust
    trust = _faded(counts.reshape(height, width)).ravel()[asked]
    slopes, share = np.zeros((len(flat), 2)), np.ones(len(flat))
    slopes[asked] = trust[:, None] * _slopes(along, down, normals[asked], form)
    dark = open_ / np.maximum(more.reshape(-1, 4)[asked, 3], 0.1)
    share[asked] = 1.0 + _DARKENED * trust * (dark - 1.0)
    leaning, open_sheet = slopes.reshape(height, width, 2), share.reshape(height, width)
    leaning[:, width // 2 :] = leaning[:, width // 2 - 1 :: -1] * [-1.0, 1.0]
    open_sheet[:, width // 2 :] = open_sheet[:, width // 2 - 1 :: -1]
    return Relief(_smoothed(leaning), _smoothed(open_sheet[..., None])[..., 0])


def _faded(trust: F8) -> F8:
    """Return trust that fades out inside of its edges, so that none of them is seen, [height, width]."""
    from scipy.ndimage import minimum_filter, uniform_filter

    kept = minimum_filter(trust, 2 * _FADE + 1, mode="nearest")
    return np.asarray(uniform_filter(kept, 2 * _FADE + 1, mode="nearest"))


def _smoothed(sheet: F8) -> F8:
    """Return means over 3x3 texels, weighted (1, 2, 1) along both axes."""
    for axis in (0, 1):
        sheet = 0.5 * sheet + 0.25 * (np.roll(sheet, 1, axis) + np.roll(sheet, -1, axis))
    return sheet


def _seen(head: Head, places: F8) -> NDArray[np.bool_]:
    turns = turns_of(places - head.middle)
    wide, low, high = _SEEN
    found: NDArray[np.bool_] = (np.abs(turns[:, 0]) < wide) & (turns[:, 1] > low) & (turns[:, 1] < high)
    return found


def _form(head: Head, places: F8, normals: F8) -> tuple[F8, F8, F8]:
    """Return unit normals of the shape below points [n, 3], its openness to the sky [n], and the trust in both [n]."""
    parts = []
    for start in range(0, len(places), _BATCH):
        at, up = places[start : start + _BATCH], normals[start : start + _BATCH]
        away = head.field.at(at)
        on = at - away[:, None] * up
        slope = gradient(head.field, on)
        unit = slope / np.maximum(np.linalg.norm(slope, axis=1), 1e-9)[:, None]
        level = (unit * (at - head.middle)).sum(axis=1) / np.linalg.norm(at - head.middle, axis=1)
        trust = step(_STRANGE, _TRUSTED, np.abs(away)) * step(0.2, 0.6, (unit * up).sum(axis=1))
        trust = trust * step(0.12, 0.45, level)  # where the form stands off the picture's sphere texels are few
        trust = trust * step(*_CHIN, turns_of(at - head.middle)[:, 1])
        parts.append((unit, 0.45 + 0.55 * openness(head.field, on, unit), trust))
    unit, open_, trust = (np.concatenate([part[i] for part in parts]) for i in range(3))
    return unit, open_, trust


def _slopes(along: F8, down: F8, normals: F8, form: F8) -> F8:
    """Return slopes that turn normals of triangles into those of the shape, as shaders/common/material.glsl reads them.

    Args:
        along: Steps from texel to texel to the right [m], [n, 3].
        down: The same downwards.
        normals: Of the triangles, between their corners', [n, 3].
        form: Of the form, [n, 3].
    """
    one, two = np.cross(down, normals), np.cross(normals, along)  # gradients of u and v, times the same figure
    size = np.sign((np.cross(along, down) * normals).sum(axis=1))[:, None]
    one, two = size * one, size * two
    longest = np.sqrt(np.maximum((one * one).sum(axis=1), (two * two).sum(axis=1)))
    longest = np.maximum(longest, 1e-12)[:, None]
    frames = np.stack([one / longest, -two / longest, normals], axis=2)
    frames[np.abs(np.linalg.det(frames)) < 1e-3] = np.eye(3)
    seen = np.linalg.solve(frames, form[:, :, None])[:, :, 0]
    result: F8 = np.clip(seen[:, :2] / np.maximum(seen[:, 2:], 0.1), -_STEEPEST, _STEEPEST)
    return result
