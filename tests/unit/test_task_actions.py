"""Adaptable parameters: limits, steps, maps, rates; the task's meaning; the action file."""

from __future__ import annotations

import json
import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.loop import haptic_objects
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.orders import Feature, HapticField
from mimics_app.contracts.messages.stage_messages import TaskAction, UserState
from mimics_app.learning.action_sequence import ActionSequence, load_action_sequence
from mimics_app.tasks.actions import build_action_space, settings_for
from mimics_app.tasks.adaptation import Adaptation
from mimics_app.tasks.check import check_task, haptic_targets
from mimics_app.tasks.task import TaskSpec

SPACE = ActionSpace([Parameter("radius", 1.0, 0.5, 2.0, step=0.25), Parameter("stiffness", 800.0, 100.0, 2000.0)])
WIDTH, SKY = Feature("tunnel.radius_scale", 1.0), Feature("sky", "day")
FEATURES = {feature.name: feature for feature in (WIDTH, SKY)}
TUNNEL = {
    "radius": {
        "default": 1.0,
        "min": 0.5,
        "max": 2.0,
        "maps": [{"to": "haptic.tunnel.radius_scale"}, {"to": "visual.tunnel.radius_scale"}],
    },
    "assistance": {
        "default": 0.0,
        "min": 0.0,
        "max": 1.0,
        "step": 0.5,
        "maps": [
            {"to": "haptic.tunnel.centring", "scale": 200.0},
            {"to": "haptic.tunnel.advance", "offset": 1.0, "scale": 4.0},
        ],
    },
    "appearance": {
        "default": 0.0,
        "min": 0.0,
        "max": 2.0,
        "step": 1.0,
        "maps": [{"to": "visual.sky", "table": ["day", "dusk", "night"]}, {"to": "audio.gain", "table": [1, 0.5, 0]}],
    },
}


def task(**fields):
    return msgspec.convert(fields, TaskSpec)


def test_clip_moves_inside_and_names_what_it_clipped():
    action, clipped = SPACE.clip(TaskAction({"radius": 5.0, "stiffness": 99.0}, at_trial=3))
    assert action == TaskAction({"radius": 2.0, "stiffness": 100.0}, at_trial=3)
    assert clipped == ("radius", "stiffness")


def test_value_exactly_at_its_limit_is_not_clipped():
    assert SPACE.clip(TaskAction({"radius": 0.5, "stiffness": 2000.0}))[1] == ()


def test_rounding_to_a_step_is_no_clipping():
    assert SPACE.clip(TaskAction({"radius": 0.9})) == (TaskAction({"radius": 1.0}), ())


def test_what_is_unknown_or_no_number_is_left_out_and_named():
    action, clipped = SPACE.clip(TaskAction({"gravity": 1.0, "radius": math.nan, "stiffness": math.inf}))
    assert action.values == {"stiffness": 2000.0}
    assert clipped == ("gravity", "radius", "stiffness")


@given(
    low=st.floats(-1e3, 1e3),
    span=st.floats(0.0, 1e3),
    step=st.one_of(st.just(0.0), st.floats(1e-3, 1e3)),
    value=st.floats(allow_nan=False),
)
def test_clipping_twice_is_clipping_once(low, span, step, value):
    parameter = Parameter("p", low, low, low + span, step)
    once = parameter.clip(value)
    assert parameter.fits(once)
    assert parameter.clip(once) == once


def test_maps_are_affine_and_go_to_their_groups():
    settings = settings_for(task(parameters=TUNNEL), {"radius": 1.5, "assistance": 0.5}, FEATURES)
    assert settings.haptic == {
        HapticField("radius_scale", "tunnel"): 1.5,
        HapticField("centring", "tunnel"): 100.0,
        HapticField("advance", "tunnel"): 3.0,
    }
    assert settings.visual == {WIDTH: 1.5}


@pytest.mark.parametrize(
    ("value", "sky", "gain"),
    [(0.0, "day", 1.0), (0.4, "day", 0.8), (1.0, "dusk", 0.5), (1.6, "night", 0.2), (2.0, "night", 0.0)],
)
def test_tables_interpolate_numbers_and_choose_words(value, sky, gain):
    settings = settings_for(task(parameters=TUNNEL), {"appearance": value}, FEATURES)
    assert settings.visual[SKY] == sky
    assert settings.audio["gain"] == pytest.approx(gain, abs=1e-12)


def test_haptic_targets_are_single_numbers_of_the_record():
    assert {"tunnel.stiffness", "tunnel.radius_scale", "virtual_mass"} <= haptic_targets()
    assert not {"sequence", "target", "tunnel", "tunnel.radius", "controller", "trial"} & haptic_targets()
    for name in haptic_targets():
        group, _, field = name.partition(".")
        assert (haptic_objects.TUNNEL[field] if field else SCENE[group]).kind == "f"


def test_a_sound_task_has_no_faults():
    triggers = [{"when": {"kind": "key", "key": "m"}, "do": [{"kind": "action", "values": {"radius": 1}}]}]
    assert check_task(task(parameters=TUNNEL, triggers=triggers)) == []
    assert check_task(TaskSpec()) == []


def parameter(**changes):
    return {"parameters": {"a/b": {"default": 1.0, "min": 0.0, "max": 2.0, "maps": [], **changes}}}


@pytest.mark.parametrize(
    ("fields", "pointer", "fix"),
    [
        (parameter(max=-1.0), "/parameters/a~1b/max", "exchange"),
        (parameter(default=2.1), "/parameters/a~1b/default", "inside"),
        (parameter(maps=[{"to": "haptic.tunnel.stifness"}]), "/parameters/a~1b/maps/0/to", '"tunnel.stiffness"'),
        (parameter(maps=[{"to": "haptik.x"}]), "/parameters/a~1b/maps/0/to", '"haptic"'),
        (parameter(maps=[{"to": "visual"}]), "/parameters/a~1b/maps/0/to", "visual.NAME"),
        (parameter(maps=[{"to": "task.timelimit_s"}]), "/parameters/a~1b/maps/0/to", '"time_limit_s"'),
        (parameter(maps=[{"to": "haptic.virtual_mass", "table": ["x"]}]), "/parameters/a~1b/maps/0/table", "numbers"),
        (parameter(maps=[{"to": "visual.x", "table": []}]), "/parameters/a~1b/maps/0/table", "one entry per step"),
        (parameter(step=1.0, maps=[{"to": "visual.x", "table": [1, 2]}]), "/parameters/a~1b/maps/0/table", "per step"),
        ({"trials": [{"trials": [{}, {"values": {"x": 1}}]}]}, "/trials/0/trials/1/values/x", "no parameters"),
        (
            {"triggers": [{"when": {"kind": "contact"}, "do": [{"kind": "action", "values": {"x": 1}}]}]},
            "/triggers/0/do/0/values/x",
            "no parameters",
        ),
        ({"score": {"time": {"weight": 1, "best": 3, "worst": 3}}}, "/score/time/worst", "apart"),
        (
            {
                "score": {
                    n: {"weight": 0, "best": 0, "worst": 1} for n in ("time", "path_error", "contacts", "smoothness")
                }
            },
            "/score",
            "weight",
        ),
        (parameter(maps=[{"to": "stiffness"}]), "/parameters/a~1b/maps/0/to", "haptic"),
    ],
)
def test_each_fault_of_a_task_has_its_pointer_and_fix(fields, pointer, fix):
    issues = check_task(task(**fields), "/task", "scene.json")
    assert [issue.pointer for issue in issues] == ["/task" + pointer]
    assert fix in issues[0].fix and issues[0].file == "scene.json"


def test_all_faults_come_at_once():
    fields = parameter(default=9.0, maps=[{"to": "x.y"}])
    assert len(check_task(task(**fields, score={"time": {"weight": 1, "best": 3, "worst": 3}}))) == 3


def test_values_without_a_rate_wait_for_the_next_trial():
    adaptation = Adaptation(SPACE)
    adaptation.begin_trial(0, {})
    adaptation.take(TaskAction({"radius": 1.5}))
    adaptation.step(100.0)
    assert adaptation.values["radius"] == 1.0
    adaptation.begin_trial(1, {})
    assert adaptation.values["radius"] == 1.5


def test_rate_limits_the_way_and_ends_exactly_at_the_aim():
    adaptation = Adaptation(ActionSpace([Parameter("x", 0.0, -1.0, 1.0, rate=0.5)]))
    adaptation.take(TaskAction({"x": -0.3}))
    seen = []
    for _ in range(7):
        adaptation.step(0.1)
        seen.append(adaptation.values["x"])
    assert seen[:5] == pytest.approx([-0.05, -0.1, -0.15, -0.2, -0.25])
    assert seen[6] == -0.3


def test_values_of_a_trial_hold_for_that_trial_only():
    adaptation = Adaptation(SPACE)
    adaptation.begin_trial(0, {"stiffness": 1900.0})
    adaptation.take(TaskAction({"radius": 1.5}))
    adaptation.begin_trial(1, {})
    assert adaptation.values == {"radius": 1.5, "stiffness": 800.0}  # the action stays, the condition does not


def test_actions_for_a_trial_come_after_its_list_and_late_ones_are_not_lost():
    adaptation = Adaptation(SPACE)
    adaptation.take(TaskAction({"stiffness": 900.0}, at_trial=0))
    adaptation.take(TaskAction({"radius": 2.0}, at_trial=1))
    adaptation.begin_trial(1, {"radius": 0.5, "stiffness": 100.0})
    assert adaptation.values == {"radius": 2.0, "stiffness": 900.0}


def write(folder, document):
    path = folder / "actions.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document), encoding="utf-8")
    return path


def test_action_file_is_replayed_each_action_once_at_its_time(tmp_path):
    document = [
        {"t": 2.0, "values": {"radius": 2.0}, "x-why": "harder"},
        {"trial": 1, "values": {"stiffness": 500}},
        {"t": 2.0, "values": {"radius": 1.0}},
    ]
    sequence = load_action_sequence(write(tmp_path, document), SPACE)
    start = 5_000_000_000
    state = UserState(0)
    assert sequence.choose(state, None, None, start) == TaskAction({"stiffness": 500.0}, at_trial=1)
    assert sequence.choose(state, None, None, start + 1_999_999_999) is None
    assert sequence.choose(state, None, None, start + 2_000_000_000) == TaskAction({"radius": 2.0})
    assert sequence.choose(state, None, None, start + 2_000_000_000) == TaskAction({"radius": 1.0})
    assert sequence.choose(state, None, None, start + 9_000_000_000) is None


@pytest.mark.parametrize(
    ("document", "faults"),
    [
        ([{"t": 0, "values": {"raduis": 1}}], [("/0/values/raduis", 'did you mean "radius"')]),
        ([{"t": 0, "values": {"radius": 3}}], [("/0/values/radius", "inside")]),
        ([{"t": 0, "values": {"radius": True}}], [("/0/values/radius", "0.5 to 2")]),
        ('[{"t": 0, "values": {"radius": NaN}}]', [("/0/values/radius", "write a number")]),
        ('[{"t": 0, "values": {"radius": 1' + "0" * 400 + "}}]", [("/0/values/radius", "")]),
        ([{"t": 0, "values": {"a/b": 1}}], [("/0/values/a~1b", "known: radius, stiffness")]),
        ([{"values": {"radius": 1}}], [("/0", "exactly one")]),
        ([{"t": 0, "trial": 1, "values": {"radius": 1}}], [("/0", "exactly one")]),
        ([{"t": -1, "values": {"radius": 1}}], [("/0/t", "seconds")]),
        ('[{"t": Infinity, "values": {"radius": 1}}]', [("/0/t", "write a number")]),
        ([{"trial": 1.5, "values": {"radius": 1}}], [("/0/trial", "whole")]),
        ([{"trial": -1, "values": {"radius": 1}}], [("/0/trial", "whole")]),
        ([{"t": 0, "values": {}}], [("/0/values", "NAME")]),
        ([{"t": 0, "vales": {"radius": 1}}], [("/0/vales", '"values"'), ("/0/values", "NAME")]),
        (
            [7, {"t": "x", "values": {"radius": 9}}],
            [("/0", "write"), ("/1/t", "seconds"), ("/1/values/radius", "inside")],
        ),
        ([{"trial": 1, "values": {"radius": 1}}] * 2, [("/1/trial", "join")]),
        ({"t": 0}, [("", "write [")]),
        ("[", [("", "")]),
        ("[" * 100_000, [("", "")]),
    ],
)
def test_each_fault_of_an_action_file_has_its_pointer_and_fix(tmp_path, document, faults):
    path = write(tmp_path, document)
    with pytest.raises(SceneError) as caught:
        load_action_sequence(path, SPACE)
    assert [issue.pointer for issue in caught.value.issues] == [pointer for pointer, _ in faults]
    for issue, (_, fix) in zip(caught.value.issues, faults, strict=True):
        assert issue.file == str(path) and fix in issue.fix
    assert caught.value.exit_code == 3


def test_action_file_that_is_not_there(tmp_path):
    with pytest.raises(SceneError, match="no such file"):
        load_action_sequence(tmp_path / "none.json", SPACE)


def test_action_file_for_a_task_without_parameters(tmp_path):
    with pytest.raises(SceneError, match="no parameters"):
        load_action_sequence(write(tmp_path, [{"t": 0, "values": {"radius": 1}}]), build_action_space(TaskSpec()))


def test_an_empty_sequence_leaves_the_task_alone():
    assert ActionSequence().choose(UserState(0), None, None, 0) is None
