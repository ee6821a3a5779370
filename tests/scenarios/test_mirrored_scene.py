"""A mirror's world after a frame of a session is the session's, with its cords, its particles and its sounds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.mirror.mirror_display import MirroredScene
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare
from mimics_app.app.session.state_mirror import StateMirror
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.messages.mirror_frame import read_frame, write_frame
from mimics_app.contracts.system.resources import root


def scene_file(name: str) -> Path:
    return root() / "scenes" / f"{name}.json"


@pytest.mark.parametrize("name", ["avatar_cord", "wavy_tunnel", "pick_and_place"])
def test_cords_particles_and_poses_are_those_of_the_session(name: str) -> None:
    settings = RunSettings(scene_file(name), headless=True, sound="off", patient="severe")
    with open_core(prepare(settings, live=False)) as core:
        mirror, frames = StateMirror(core.world), Frames(core)
        for _ in range(360):
            frames.advance_frame()
            mirror.listen(frames, core.clock.now_ns())
        for emitter in core.world.effects.emitters.values():
            core.world.effects.trigger(emitter.trigger, (0.1, 0.2, 0.3))
        shown = MirroredScene(str(scene_file(name)), core.scene.hash)
        seen = read_frame(write_frame(mirror.frame(frames, core.clock.now_ns())))
        shown.show(seen)
        for cord, other in zip(core.world.cords.values(), shown.world.cords.values(), strict=True):
            for one, two in ((cord.ends, other.ends), (cord.ball, other.ball), (cord.taps, other.taps)):
                np.testing.assert_array_equal(one, two)
            np.testing.assert_array_equal(cord.curve.point(0.3), other.curve.point(0.3))
            assert (cord.shown_radius, cord.colour, cord.visible) == (other.shown_radius, other.colour, other.visible)
        ours, theirs = core.world.effects, shown.world.effects
        assert (ours.time, ours.seed, len(ours.bursts)) == (theirs.time, theirs.seed, len(theirs.bursts))
        for burst, copy in zip(ours.bursts, theirs.bursts, strict=True):
            assert (burst.emitter, burst.number, burst.born_s) == (copy.emitter, copy.number, copy.born_s)
            np.testing.assert_array_equal(burst.world_from_emitter, copy.world_from_emitter)
        moved = core.world.transforms
        np.testing.assert_allclose(shown.world.transforms.world[seen.rows], moved.world[seen.rows], atol=1e-5)
        if name == "wavy_tunnel":
            heard = {note.name for note in seen.sounds}
            assert {"start", "contact"} <= heard, "touches and cues, besides the orders of the task"
        else:
            assert core.world.cords or ours.bursts, "it has something to compare"
