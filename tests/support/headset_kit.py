"""What every headset keeps to, simulated or real: run by the tests of each runtime."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.ports.display_port import DisplayFrame, HeadsetState, Viewpoint
from mimics_app.rendering.visual.displays.headset_session import HeadsetDisplay

FOV = math.radians(60.0)


def draw_frame(display: HeadsetDisplay, now_ns: int, texture: int = 0) -> bool:
    """One frame by the book; whether somebody saw it."""
    timing = display.begin_frame(now_ns)
    if not timing.render:
        display.end_frame(None)
        return False
    drawn = display.drawn_size((200, 100))
    viewpoint = Viewpoint(np.eye(4), FOV)
    display.eyes(viewpoint, drawn, timing.display_ns)
    eyes = display.eyes(viewpoint, drawn, timing.display_ns)  # late latch: located again
    blank = np.zeros((drawn[1], drawn[0], 4), np.uint8)
    display.end_frame(DisplayFrame(eyes, drawn, texture, lambda: blank))
    return True


def check_headset(display: HeadsetDisplay, frames: int = 20, texture: int = 0) -> None:
    """States come in order, frames are paired, both eyes look along their own axes and are apart."""
    seen = sum(draw_frame(display, frame * 11_111_111, texture) for frame in range(frames))
    assert seen > 0
    assert display.state in (HeadsetState.VISIBLE, HeadsetState.FOCUSED)
    width, height = display.drawn_size((200, 100))
    assert width % 2 == 0 and height > 0
    timing = display.begin_frame(frames * 11_111_111)
    assert timing.period_ns > 0
    left, right = display.eyes(Viewpoint(np.eye(4), FOV), (width, height), timing.display_ns)
    assert (left.name, right.name) == ("left", "right")
    assert left.rectangle == (0, 0, width // 2, height)
    assert right.rectangle == (width // 2, 0, width // 2, height)
    for eye in (left, right):
        np.testing.assert_allclose(eye.world_from_eye[:3, :3].T @ eye.world_from_eye[:3, :3], np.eye(3), atol=1e-6)
        assert eye.tangents[0] < eye.tangents[1] and eye.tangents[2] < eye.tangents[3]
    assert 0.03 < np.linalg.norm(left.world_from_eye[:3, 3] - right.world_from_eye[:3, 3]) < 0.1
    display.end_frame(None)
    display.close()
