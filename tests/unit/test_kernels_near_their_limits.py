"""Kernels of the picture where a shortcut would show: opposite quaternions, triangles edge on, joints of cells."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from mimics_app.rendering.visual.kernels.skin import skin_dual
from mimics_app.rendering.visual.software.kernels.triangles import _is_turned
from mimics_app.rendering.visual.software.screen_places import cover_of, parts_of

SEED = 32


def duals_of(turns: np.ndarray, moves: np.ndarray) -> np.ndarray:
    """Dual quaternions, float32 [n, 8], of rotations xyzw and translations: the dual part is half of move x turn."""
    x, y, z, w = turns.T
    mx, my, mz = moves.T
    dual = np.stack(
        (
            0.5 * (mx * w + my * z - mz * y),
            0.5 * (my * w + mz * x - mx * z),
            0.5 * (mz * w + mx * y - my * x),
            -0.5 * (mx * x + my * y + mz * z),
        ),
        axis=1,
    )
    return np.concatenate((turns, dual), axis=1).astype(np.float32)


def test_a_skin_does_not_depend_on_the_sign_of_a_joint_s_quaternion() -> None:
    """q and -q are one rotation. Bends below 90 degrees, so that no blend is undecided."""
    chance = np.random.default_rng(SEED)
    joints, vertices = 12, 400
    axis = chance.normal(size=(joints, 3))
    angle = chance.uniform(0.0, 0.5 * math.pi, joints)
    turns = np.concatenate(
        (
            np.sin(0.5 * angle)[:, None] * axis / np.linalg.norm(axis, axis=1, keepdims=True),
            np.cos(0.5 * angle)[:, None],
        ),
        axis=1,
    )
    palette = duals_of(turns, chance.normal(size=(joints, 3)))
    weights = np.sort(chance.dirichlet(np.ones(4), vertices), axis=1)[:, ::-1].astype(np.float32)
    numbers = np.stack([chance.permutation(joints)[:4] for _ in range(vertices)]).astype(np.uint16)
    places = chance.normal(size=(vertices, 3)).astype(np.float32)
    normals = (places / np.linalg.norm(places, axis=1, keepdims=True)).astype(np.float32)

    def skinned(signs: np.ndarray) -> np.ndarray:
        out = np.zeros((vertices, 8), np.float32)
        duals = np.ascontiguousarray(palette * signs[:, None].astype(np.float32))
        skin_dual(places, normals, numbers, np.ascontiguousarray(weights), duals, out)
        return out

    plain = skinned(np.ones(joints))
    for _ in range(8):
        np.testing.assert_allclose(skinned(chance.choice([-1.0, 1.0], joints)), plain, atol=3e-6)
    # One joint alone: the transform itself, by matrix.
    x, y, z, w = turns[0]
    matrix = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    numbers[:], weights = 0, np.tile(np.array([1, 0, 0, 0], np.float32), (vertices, 1))
    moved = 2.0 * np.array(
        [
            w * palette[0, 4] - palette[0, 7] * x + y * palette[0, 6] - z * palette[0, 5],
            w * palette[0, 5] - palette[0, 7] * y + z * palette[0, 4] - x * palette[0, 6],
            w * palette[0, 6] - palette[0, 7] * z + x * palette[0, 5] - y * palette[0, 4],
        ]
    )
    np.testing.assert_allclose(skinned(np.ones(joints))[:, :3], places @ matrix.T + moved, atol=3e-6)


@pytest.mark.parametrize("winding", [1.0, -1.0])
def test_a_triangle_is_turned_away_only_if_no_error_of_its_corners_can_turn_it_back(winding: float) -> None:
    """The area is linear in each of six coordinates: its largest value lies in a corner of the box of errors."""
    chance, margin = np.random.default_rng(SEED), 0.0625
    shifts = np.array(list(itertools.product((-margin, margin), repeat=6))).reshape(-1, 3, 2)
    inverse, turned, spared = np.ones(3), 0, 0
    for _ in range(4000):
        corners = chance.uniform(-8.0, 8.0, (3, 2))
        along = corners[1] - corners[0]  # the third lies near the line through the others
        corners[2] = corners[0] + chance.uniform(-1, 2) * along + chance.normal(0.0, 0.25, 2)
        x, y = (np.ascontiguousarray(corners[:, k]) for k in (0, 1))
        moved = corners + shifts
        b, c = moved[:, 1] - moved[:, 0], moved[:, 2] - moved[:, 0]
        largest = float((winding * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])).max())
        bx, by, cx, cy = *(corners[1] - corners[0]), *(corners[2] - corners[0])
        seen_from_behind = winding * (bx * cy - by * cx) < 0.0
        if _is_turned(0, 1, 2, x, y, inverse, winding, margin):
            assert largest < 0.0, "an error of the corners within the margin shows its face"
            turned += 1
        else:
            spared += seen_from_behind and largest > 0.0
    assert turned > 200 and spared > 200, "both sides of the margin are tried"


@pytest.mark.parametrize("size", [(640, 360), (333, 217)])
def test_what_is_redrawn_holds_the_pixels_beside_what_changed(size: tuple[int, int]) -> None:
    """Samples of a pixel, rounding, and filters of edges reach beyond it, also where it ends at a joint of cells."""
    chance = np.random.default_rng(SEED)
    width, height = size
    joints = 0
    for _ in range(300):
        low = chance.integers(0, (width // 16, height // 16)) * 16.0
        extent = chance.integers(1, 4, 2) * 16.0 - chance.choice([0.0, 0.0, 1.0, 5.0], 2)
        left, bottom = low + chance.choice([0.0, 0.0, 3.0], 2)
        right, top = min(left + extent[0], float(width)), min(bottom + extent[1], float(height))
        joints += right % 16 == 0 and right < width
        bounds = np.array([[left / width, right / width, bottom / height, top / height]])
        needed = np.zeros((height, width), bool)
        needed[max(int(bottom) - 2, 0) : math.ceil(top) + 2, max(int(left) - 2, 0) : math.ceil(right) + 2] = True
        for parts in (parts_of(bounds, size), [each for part in cover_of(bounds, size) for each in part.pieces]):
            drawn = np.zeros((height, width), bool)
            for x, y, wide, high in parts:
                drawn[y : y + high, x : x + wide] = True
            assert not (needed & ~drawn).any()
    assert joints > 50
