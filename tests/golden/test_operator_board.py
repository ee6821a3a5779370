"""Cards and prompts of a session in a headset: over its mirror for the operator, not before the wearer's eyes."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.app.picture.picture import Picture, picture_quality
from mimics_app.app.picture.shown_on import open_display
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.messages.board import Board, Card
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.world.files.scene.file import build_world, load_scene

BOARD = Board({"trial": Card("Trial", "1"), "time": Card("Time", "7 s")}, "Look at the figure before you")


@pytest.mark.parametrize(("display", "worn"), [("sim-hmd", True), ("desktop", False)])
def test_what_the_operator_reads_is_not_before_the_eyes_of_the_wearer(display: str, worn: bool) -> None:
    scene = load_scene(root() / "scenes" / "avatar_cord.json")
    world = build_world(scene)
    world.update()
    with create_surface("egl", (640, 360)) as surface:
        picture = Picture(
            surface, scene, world, picture_quality(scene, "draft"), display=open_display(scene, display, surface)
        )
        shown = []
        for board in (Board(), BOARD):
            picture.show_frame(board, VirtualClock())
            shown.append(read_pixels(surface).astype(int))
        assert picture.renderer.hud.empty is worn
        changed = np.abs(shown[1] - shown[0]).max(axis=-1) > 8
        assert changed.mean() > 0.02, "the window shows it to the operator"
        assert changed[:120].any() and changed[240:].any(), "cards above, the prompt below"
        assert surface.ctx.error == "GL_NO_ERROR"
        picture.renderer.release()
