"""Blending of dual quaternions on the processor, against a rotation about an axis written out."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.visual.kernels.skin import skin_dual

AT, NORMAL = (0.3, -0.2, 0.5), (0.0, 1.0, 0.0)


def turned(angle: float, sign: float) -> list[float]:
    """A rotation about z and a shift by (1, 2, 3): real part, dual part 0.5 t q; either sign is the same motion."""
    x, y, z, w = 0.0, 0.0, np.sin(0.5 * angle), np.cos(0.5 * angle)
    tx, ty, tz = 1.0, 2.0, 3.0
    dual = (
        0.5 * (tx * w + ty * z - tz * y),
        0.5 * (ty * w + tz * x - tx * z),
        0.5 * (tz * w + tx * y - ty * x),
        -0.5 * (tx * x + ty * y + tz * z),
    )
    return [sign * value for value in (x, y, z, w, *dual)]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_two_joints_move_a_vertex_by_the_motion_between_them_whatever_their_signs(sign: float) -> None:
    """Rotations that differ by a little blend evenly into the one between them, with their common shift."""
    angle, apart = 2.0, 0.2
    duals = np.array([turned(angle - apart, 1.0), turned(angle + apart, sign)], np.float32)
    out = np.zeros((1, 8), np.float32)
    weights, joints = np.array([[0.5, 0.5]], np.float32), np.array([[0, 1]], np.uint16)
    skin_dual(np.array([AT], np.float32), np.array([NORMAL], np.float32), joints, weights, duals, out)
    c, s = np.cos(angle), np.sin(angle)
    wanted = (c * AT[0] - s * AT[1] + 1.0, s * AT[0] + c * AT[1] + 2.0, AT[2] + 3.0)
    np.testing.assert_allclose(out[0, :3], wanted, atol=2e-6)
    np.testing.assert_allclose(out[0, 3:6], (-s, c, 0.0), atol=2e-6)
