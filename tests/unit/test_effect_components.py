"""Effects in scene files: their faults, how they come to the world, and what sets them off in a session."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.app.session.visible_scene import EffectCues
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.reload import apply_scene
from tests.support.scenes import faults, scene, thing, write

NONE = np.zeros(0, EVENT)


def loaded(folder, document):
    return load_scene(write(folder, document))


@pytest.mark.parametrize(
    ("components", "what"),
    [
        ({"billboard": {"texture": "tree"}}, 'billboard/texture: no asset "tree"; the scene has none'),
        ({"billboard": {"size": [0, 1]}}, "billboard/size/0: expected a number > 0.0, got 0"),
        ({"billboard": {"facing": "fre"}}, 'billboard/facing: "fre" is not possible here; did you mean "free"'),
        ({"particles": {"lifetime": [2, 1]}}, "particles/lifetime: 2 is more than 1; give the minimum first"),
        ({"particles": {"speed": [2, 1]}}, "particles/speed: 2 is more than 1"),
        ({"particles": {"size": [2, 1]}}, "particles/size: 2 is more than 1"),
        ({"particles": {"direction": [0, 0, 0]}}, "particles/direction: has no length"),
        ({"particles": {"colours": []}}, "particles/colours: expected"),
        ({"particles": {"trigger": "gool"}}, 'particles/trigger: "gool" is not possible here; did you mean "goal"'),
        ({"particles": {"capacity": 0}}, "particles/capacity: expected"),
        ({"projector": {"texture": "x"}}, 'projector/texture: no asset "x"'),
        ({"projector": {"onto": ["walls"]}}, 'projector/onto/0: no entity "walls"'),
        ({"projector": {"full_angle": 1.5}}, "projector/last_angle: 1.4 rad is not beyond full_angle, 1.5 rad"),
        ({"projector": {"kind": "slide", "near": 2.0}}, "projector/near: 2 m is not nearer than depth, 1 m"),
    ],
)
def test_effects_whose_values_cannot_be(tmp_path, components, what):
    found = faults(write(tmp_path, scene(thing("a", **components))))
    assert len(found) == 1, found
    assert f"#/entities/0/components/{what}" in found[0]


def test_a_world_has_the_scenes_effects_and_a_reload_changes_them(tmp_path):
    before = scene(thing("a", billboard={}, particles={"trigger": "goal"}), thing("b", projector={}))
    old = loaded(tmp_path, before)
    world = build_world(old)
    a, b = world.find("a").index, world.find("b").index
    assert set(world.effects.billboards) == set(world.effects.emitters) == {a}
    assert set(world.effects.projectors) == {b}
    world.effects.trigger("goal")
    revision = world.effects.revision
    after = scene(thing("a", billboard={"size": [2, 3]}), thing("b", projector={}))
    apply_scene(world, old, loaded(tmp_path, after))
    assert world.effects.billboards[a].size == (2, 3)
    assert not world.effects.emitters and not world.effects.bursts
    assert world.effects.revision > revision
    apply_scene(world, loaded(tmp_path, after), loaded(tmp_path, scene(thing("a"))))
    assert world.effects.empty


def test_starts_goals_and_touches_set_off_what_waits_for_them(tmp_path):
    wanted = ("start", "goal", "contact", "contact_end", "impact")
    document = scene(*(thing(name, particles={"trigger": name, "pause": 0.0}) for name in wanted))
    world = build_world(loaded(tmp_path, document))
    cues = EffectCues(world)
    names = {world.find(name).index: name for name in wanted}
    touches = np.zeros(4, EVENT)
    kinds = (EventKind.CONTACT_BEGIN, EventKind.MARGIN, EventKind.IMPACT, EventKind.CONTACT_END)
    touches["kind"], touches["position_world"] = kinds, (1.0, 2.0, 3.0)
    touches["position_world"][3] = np.nan  # a wall has no place where one lets go of it
    states = ("ready", "travel", "travel", "finished", "finished", "ready")
    reported = []
    for frame, state in enumerate(states):
        seen = len(world.effects.bursts)
        cues.step(TaskOrders(view=TaskView(TrialState(state))), touches if frame == 2 else NONE, frame * 100_000_000)
        reported.append([names[burst.emitter] for burst in world.effects.bursts[seen:]])
    assert reported == [[], ["start"], ["contact", "impact", "contact_end"], ["goal"], [], []]
    assert world.effects.time == pytest.approx(0.5)
    place = {names[burst.emitter]: burst.world_from_emitter[:3, 3].tolist() for burst in world.effects.bursts}
    assert place["impact"] == [1.0, 2.0, 3.0] and place["contact_end"] == [0.0, 0.0, 0.0]
