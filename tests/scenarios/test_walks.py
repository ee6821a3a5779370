"""Canyon walk and soccer: what D2.1 3.3 and Table 1 ask for, seen in the shipped scenes."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from msgspec.structs import replace

import mimics_app as mimics
from mimics_app.app.api.opened import Opened
from mimics_app.app.play.scene_sound_file import write_sound
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.stage_checks import check_features
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.contracts.system.resources import root
from mimics_app.maths.gait_series import natural_cadence
from mimics_app.tasks.kinds.canyon_walk.kind import CanyonWalkPlay, CanyonWalkSpec, SectionSpec
from mimics_app.tasks.kinds.city_walk.kind import Walked
from mimics_app.tasks.scene_section import check_section, task_of
from mimics_app.tasks.score import trial_points
from mimics_app.tasks.task import DeviceTask, MapSpec, ParameterSpec
from mimics_app.tasks.walking.encouragement import Encouragement
from mimics_app.world.components.follow import Follow
from mimics_app.world.components.robot import Robot
from mimics_app.world.components.visible import CameraComponent
from tests.support.scenes import write

SCENES = root() / "scenes"
VIEWS = ["ego", "shoulder", "side", "front", "top", "free"]


def _changed(folder: Path, name: str, **section: object) -> Path:
    """The scene with other settings of its kind of task."""
    document = json.loads((SCENES / f"{name}.json").read_text())
    document["task"][name] |= section
    file = folder / f"{name}.json"
    file.write_text(json.dumps(document))
    return file


def _heard(session: Opened) -> list[tuple[str, np.ndarray]]:
    """Kind and place [m] of what would be heard of the newest frame."""
    world = session.world
    steps = [
        (event.kind, world.find(f"{world.graph.name(index)}/{event.node}").world_matrix()[:3, 3].copy())
        for index, event in world.motion.happened
    ]
    return [*steps, *((cue.kind, np.array(cue.position_world)) for cue in session.orders.audio.cues)]


@pytest.mark.parametrize("name", ["canyon_walk", "soccer"])
def test_the_six_views_are_the_first_cameras(name: str) -> None:
    scene = load_checked_scene(SCENES / f"{name}.json")
    assert [entity for entity, _, _ in scene.components(CameraComponent)][:6] == VIEWS
    followed = {entity for entity, _, _ in scene.components(Follow)}
    assert {"shoulder", "side", "front"} <= followed


@pytest.mark.parametrize(
    ("name", "sounds"),
    [
        ("city_walk", {"steps"}),
        ("canyon_walk", {"steps", "steps_on_beam", "wind_place"}),
        ("soccer", {"steps", "opponent_steps", "kick", "crowd_ahead", "crowd_behind", "cheer"}),
    ],
)
def test_the_sounds_of_table_1_are_played_in_time(tmp_path: Path, name: str, sounds: set[str]) -> None:
    sections: dict[str, dict[str, object]] = {
        "canyon_walk": {"sections": {"begin": {"begin": 16.0, "end": 40.0}}},
        "soccer": {"skill": 1.0},
    }
    section = sections.get(name, {})
    report = write_sound(
        RunSettings(_changed(tmp_path, name, **section)), tmp_path / "walk.wav", 6.0 if name == "city_walk" else 14.0
    )
    heard = {row.sound.split(":")[0] for row in report.rows}
    missing = sounds - heard - {"wind_place", "crowd_ahead", "crowd_behind", "cheer"}
    assert not missing, (missing, heard)
    assert max(row.latency_ms for row in report.rows) < 20.0


def test_the_beam_is_walked_and_its_feet_are_measured(tmp_path: Path) -> None:
    """A broad beam is not missed; one as narrow as the step is, and each misstep is heard where the foot came down."""
    results = []
    for width in (1.2, 0.2):
        file = _changed(tmp_path, "canyon_walk", sections={"begin": {"begin": 30.0, "end": 42.0}})
        document = json.loads(file.read_text())
        document["task"]["parameters"]["beam_width"] |= {"default": width, "min": 0.2}
        file.write_text(json.dumps(document))
        heard: list[tuple[str, np.ndarray]] = []
        with mimics.open(file, record=False) as session:
            session.step_until(lambda s: s.orders.person_may_act)
            for _ in range(60 * 15):
                session.step()
                heard += _heard(session)
            results.append((session.task, heard))
    (broad, quiet), (narrow, loud) = results
    assert broad["missteps"] == 0 and not [kind for kind, _ in quiet if kind == "misstep"]
    missed = [place for kind, place in loud if kind == "misstep"]
    assert narrow["missteps"] == len(missed) > 3 and narrow["on_beam_share"] < 1.0
    assert all(abs(place[0]) + 0.045 > 0.1 for place in missed)


def test_steps_on_the_beam_sound_of_wood_and_before_it_of_the_street(tmp_path: Path) -> None:
    file = _changed(tmp_path, "canyon_walk", sections={"begin": {"begin": 15.0, "end": 40.0}})
    steps: list[tuple[str, float]] = []
    with mimics.open(file, record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        for _ in range(60 * 12):
            session.step()
            z = float(session.world.find("person").world_matrix()[2, 3])
            steps += [(event.material, z) for _, event in session.world.motion.happened if event.kind == "step"]
    assert {material for material, z in steps if z < -20.5} == {"wood"}
    assert {material for material, z in steps if z > -19.5} == {"asphalt"}
    assert len(steps) > 10


def test_the_sounds_of_soccer_are_where_their_cause_is(tmp_path: Path) -> None:
    """Table 1: steps at the feet of who steps, a kick at the ball; the level follows by the inverse law."""
    file = _changed(tmp_path, "soccer", skill=1.0)
    far: dict[str, list[float]] = {"step": [], "opponent_step": [], "kick": []}
    causes = {"step": "person", "opponent_step": "opponent", "kick": "ball"}
    with mimics.open(file, record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        for _ in range(60 * 14):
            session.step()
            for kind, place in _heard(session):
                if kind in far:
                    at = session.world.find(causes[kind]).world_matrix()[:3, 3]
                    far[kind].append(float(np.linalg.norm((place - at)[::2])))
    assert min(len(each) for each in far.values()) >= 1 and len(far["step"]) > 8
    assert max(far["step"] + far["opponent_step"]) < 0.6 and max(far["kick"]) < 0.4, far
    sound = next(e for e in json.loads(file.read_text())["entities"] if e["id"] == "opponent_steps")["components"]
    assert sound["sound"]["reference_distance"] == 1.0 and len(far["opponent_step"]) > 6


def test_legs_in_the_gait_orthosis_walk_the_shipped_scene() -> None:
    """With `--device lokomat:sim` nobody moves a hand; the healthy person keeps step with the reference, unstopped."""
    with mimics.open("canyon_walk", device="lokomat:sim", record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        session.step(9.0)
        result = session.task
        assert session.state["state"] == SafetyState.ACTIVE
    assert result["distance_m"] > 2.0
    natural = 9.0 * 2.0 * natural_cadence(0.4, 1.75)
    assert natural - 3.0 <= result["steps"] <= natural + 1.0, "a step of a foot a cycle, not two"
    assert result["symmetry"] > 0.9


def test_a_foot_of_the_orthosis_does_not_turn_the_eyes_in_the_city() -> None:
    """By hand the point of contact looks about; in the orthosis it is a foot, which swings."""
    with mimics.open("city_walk", device="lokomat:sim", record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        feet, gaze = [], []
        for _ in range(110):
            session.step()
            feet.append(session.state["hip_world"][0, 0])
            gaze.append(session.world.cameras[0].world_from_eye[0, 2])
    assert np.ptp(feet) > 0.03, "the foot has moved"
    assert np.ptp(gaze) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("person", ["moderate", "severe"])
def test_an_impaired_person_comes_to_the_end_of_the_city_walk_in_the_orthosis(person: str) -> None:
    """The belt walks at 0.15 to 0.3 m/s and waits at each obstacle: the way by hand would take half an hour."""
    rows: list[dict[str, object]] = []
    with mimics.open("city_walk", device="lokomat:sim", patient=person, trials=1, record=False) as session:
        session.on_trial(rows.append)
        session.step_until(lambda _: bool(rows), 330.0)
    assert rows[0]["outcome"] == "finished"
    assert float(rows[0]["walked_m"]) >= 30.0  # type: ignore[arg-type]
    assert float(rows[0]["obstacles"]) >= 2.0  # type: ignore[arg-type]


def test_every_walk_is_played_in_the_gait_orthosis_and_by_hand() -> None:
    for name in ("city_walk", "canyon_walk", "soccer"):
        hand = load_checked_scene(SCENES / f"{name}.json")
        assert load_checked_scene(SCENES / f"{name}.json", device="pointer").hash == hand.hash
        legs = load_checked_scene(SCENES / f"{name}.json", device="lokomat:udp:10.0.0.2:5000")
        assert hand.devices == ("lokomat",)
        assert (hand.first(Robot) or Robot()).device == "simulated_hapticmaster"
        robot = legs.first(Robot)
        assert robot is not None and robot.device == "lokomat:sim"
        assert {each.id for each in hand.entities} - {each.id for each in legs.entities} == set()
        assert hand.hash != legs.hash
        assert "hand" in task_of(hand).instructions and "hand" not in task_of(legs).instructions
        ends = [goal.distance(True) for goal in task_of(legs).goals if isinstance(goal, Walked)]
        assert all(f"{metres:.0f} m" in task_of(legs).instructions for metres in ends)


def test_a_parameter_of_a_device_is_checked_as_those_of_the_task() -> None:
    scene = load_checked_scene(SCENES / "soccer.json")
    maps = [MapSpec("visual.snow"), MapSpec("haptic.bodies.nobody.mass")]
    guidance = ParameterSpec(default=1.0, min=0.0, max=1.0, maps=maps)
    task = replace(task_of(scene), devices={"lokomat": DeviceTask(parameters={"guidance": guidance})})
    scene.sections["task"] = task
    place = "/task/devices/lokomat/parameters/guidance/maps"
    assert [issue.pointer for issue in check_features(scene)] == [f"{place}/0/to"]
    found = {issue.pointer: issue.what for issue in check_section(task, scene)}
    assert found[f"{place}/1/to"] == 'no entity is called "nobody"'


def test_a_task_for_a_device_without_entities_is_refused(tmp_path: Path) -> None:
    document = json.loads((SCENES / "city_walk.json").read_text())
    document["task"]["devices"]["glove"] = {"instructions": "Close the hand."}
    with pytest.raises(SceneError, match='/task/devices/glove: the section devices has no "glove"'):
        load_checked_scene(write(tmp_path, document))


@pytest.mark.slow
@pytest.mark.parametrize("walk", ["city_walk", "canyon_walk", "soccer"])
def test_in_the_orthosis_too_who_walks_better_scores_more(walk: str) -> None:
    """By what a led person does: in the canyon 99, 67 and 55 of 100, by steps of 0.45, 0.29 and 0.15 m."""
    scores = []
    for person in ("healthy", "moderate", "severe"):
        with mimics.open(walk, device="lokomat:sim", patient=person, record=False) as session:
            session.step_until(lambda s: s.orders.person_may_act)
            for _ in range(60 * 40):
                session.step()
            score = task_of(session.scene).score
            scores.append(trial_points(score, dict(session.task), finished=True))
    assert scores[0] > scores[1] + 5.0 > scores[2] + 10.0 > 30.0, scores


def test_who_leans_over_the_edge_hears_what_to_do() -> None:
    """Before the fall, and after it: the hand that stays aside would only make them fall again."""
    spec = CanyonWalkSpec("person", "beam", calm=True, sections={"": SectionSpec(30.0, 60.0)})
    play = CanyonWalkPlay(spec, 1)
    said: list[str] = []
    seen = SimpleNamespace(hip_world=(0.0, 0.0, 0.0), grasp=0.0, pressed=(), now_ns=0)
    play.begin_trial("", 0)
    play.start_attempt(seen)  # type: ignore[arg-type]
    seen.hip_world = (0.1, 0.1, 0.0)  # up, and to the right
    while not play.measures["falls"] and len(said) < 600:
        play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
        said.append(play.prompt)
    assert "The edge is near: lean to the left" in said
    assert said[-1] == "Never mind. You are back on the beam: move the hand back to the middle"
    seen.hip_world = (0.0, 0.1, 0.0)
    play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
    assert play.prompt == "Never mind. You are back on the beam: breathe, then raise the hand"


def test_who_falls_back_behind_a_mark_is_not_encouraged_for_it_again() -> None:
    encouragement, said = Encouragement(), list[str]()
    for progress in [0.4] * 3 + [0.51] * 300 + [0.49] * 300 + [0.51] * 300 + [0.91] * 30 + [0.89] * 300:
        encouragement.follow(progress, 1.0 / 60.0)
        said += [encouragement.words] if encouragement.words not in said[-1:] else []
    assert said == ["", "Half the way is done: well walked", "", "Nearly there: a few more steps", ""]


def test_who_walks_in_a_room_is_not_told_of_a_hand() -> None:
    spec = CanyonWalkSpec("person", "beam", calm=True, room_gain=2.0, sections={"": SectionSpec(30.0, 60.0)})
    play, x, z = CanyonWalkPlay(spec, 1), 0.0, 0.0
    seen = SimpleNamespace(hip_world=(0.0, 0.0, 0.0), grasp=0.0, pressed=(), now_ns=0, head=HeadPlace(x, z, 0.0))
    play.begin_trial("", 0)
    play.start_attempt(seen)  # type: ignore[arg-type]
    for _ in range(600):
        seen.head = HeadPlace(x, z, 0.0)
        play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
        if play.measures["falls"]:
            break
        x, z = 0.3, z - 0.01
    assert play.prompt == "Never mind. You are back on the beam: step back to where you began"
    seen.head = HeadPlace(0.0, z, 0.0)
    play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
    assert play.prompt == "Never mind. You are back on the beam: breathe, then walk on"
