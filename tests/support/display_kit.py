"""Conformance kit of displays: what the renderer takes for granted of one, built in or of a package."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.ports.display_port import Display, DisplayFrame, Viewpoint

SHOWN = (640, 360)
FRAMES = 3
FRAME_NS = 16_666_667


def check_display(display: Display) -> None:
    """Play a few frames as a session does; raises AssertionError at what a display must not do."""
    turned = np.array([[0.0, 0.0, 1.0, 0.3], [0.0, 1.0, 0.0, 1.6], [-1.0, 0.0, 0.0, -0.2], [0.0, 0.0, 0.0, 1.0]])
    viewpoint = Viewpoint(turned, 0.9)
    drawn = display.drawn_size(SHOWN)
    assert len(drawn) == 2 and min(drawn) >= 1, "the drawn picture has a size"
    names = set()
    for number in range(FRAMES):
        now = number * FRAME_NS
        timing = display.begin_frame(now)
        assert timing.display_ns >= now and timing.period_ns >= 0, "a frame is shown after it begins"
        eyes = display.eyes(viewpoint, drawn, timing.display_ns)
        names.add(tuple(eye.name for eye in eyes))
        _check_eyes(eyes, drawn)
        again = display.eyes(viewpoint, drawn, timing.display_ns)
        assert [eye.rectangle for eye in again] == [eye.rectangle for eye in eyes], "the late latch moves poses only"
        pixels = np.zeros((drawn[1], drawn[0], 4), np.uint8)
        display.end_frame(DisplayFrame(again, drawn, 0, lambda pixels=pixels: pixels))
    assert len(names) == 1, "files are named by eyes: their names stay"
    assert all(fault.strip() == fault and "\n" not in fault for fault in display.take_faults()), "a fault is one line"
    assert display.take_faults() == [], "a fault is reported once"
    assert not display.leaving
    display.close()


def _check_eyes(eyes, drawn) -> None:
    """The eyes of one frame: rigid poses, open frusta, rectangles inside the picture that do not overlap."""
    assert eyes and len({eye.name for eye in eyes}) == len(eyes), "each eye has a name of its own"
    covered = np.zeros((drawn[1], drawn[0]), bool)
    for eye in eyes:
        pose = eye.world_from_eye
        assert pose.shape == (4, 4) and pose.dtype == np.float64
        np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-9, err_msg="rigid")
        assert np.linalg.det(pose[:3, :3]) > 0.0 and pose[3].tolist() == [0.0, 0.0, 0.0, 1.0]
        left, right, bottom, top = eye.tangents
        assert np.isfinite(eye.tangents).all() and left < right and bottom < top
        x, y, width, height = eye.rectangle
        assert x >= 0 and y >= 0 and width >= 1 and height >= 1 and x + width <= drawn[0] and y + height <= drawn[1]
        assert not covered[y : y + height, x : x + width].any(), "no two eyes draw the same pixel"
        covered[y : y + height, x : x + width] = True
    for pair in {eye.pair for eye in eyes} - {-1}:
        assert sum(eye.pair == pair for eye in eyes) == 2, "a stereo pair is two eyes"
