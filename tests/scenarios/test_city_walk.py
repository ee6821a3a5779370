"""The city walk: at the person's own speed, and every step of every walker sounds at its time as its ground."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.api.opened import Opened
from mimics_app.app.play.scene_sound_file import write_sound
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.person_input import ray_to_the_hand
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.maths import mat, quat
from mimics_app.scenarios.figures.path_figure import GroundPath
from mimics_app.world.components.walking import WalkingPath
from tests.verification.test_sound_onset import read_file

SCENE = root() / "scenes" / "city_walk.json"
RATE = 48_000
TO_THE_LAWN = 87.1
"""Where the person begins, 5 s before the lawn [m]."""


def changed(folder: Path, start: float = 0.0, **components: dict[str, Any]) -> Path:
    """The scene with the person and the companion further on, and other components of some entities."""
    document = json.loads(SCENE.read_text())
    if start:  # the obstacles are before
        del document["task"]["city_walk"]["obstacles"]
    for entity in document["entities"]:
        entity["components"] = entity.get("components", {}) | components.get(entity["id"], {})
        walker = entity["components"].get("path_walker", {})
        if walker.get("path") == "route":
            walker["start"] = walker.get("start", 0.0) + start
    file = folder / "city_walk.json"
    file.write_text(json.dumps(document))
    return file


Strike = tuple[str, int, str, np.ndarray]
"""A heel strike: who, when [ns], on what, where [m]."""


def _strikes(session: Opened) -> list[Strike]:
    """Of the newest frame."""
    now_ns, world, found = round(session.time_s * 1e9), session.world, []
    for index, event in world.motion.happened:
        name = world.graph.name(index)
        found.append((name, now_ns, event.material, world.find(f"{name}/{event.node}").world_matrix()[:3, 3].copy()))
    return found


def walked(file: Path, seconds: float) -> tuple[list[Strike], np.ndarray]:
    """Heel strikes of a time [s] from the begin of the trial on, and of the others before; where the eyes look."""
    steps: list[Strike] = []

    def begun(session: Opened) -> bool:
        steps.extend(_strikes(session))
        return session.orders.person_may_act

    with mimics.open(file, record=False) as session:
        session.step_until(begun)
        for _ in range(round(seconds * 60)):
            session.step()
            steps += _strikes(session)
        return steps, -session.world.cameras[0].world_from_eye[:3, 2]


def test_each_step_sounds_at_its_time_as_its_ground(tmp_path: Path) -> None:
    """D2.1 Table 1, city walk: stepping sounds. The spectra of both grounds are told by their bands."""
    file = changed(tmp_path, TO_THE_LAWN)
    steps, _ = walked(file, 7.5)
    by_walker = {name: [step for step in steps if step[0] == name] for name in ("own_body", "companion", "neighbour")}
    for name, of_one in by_walker.items():
        spacing = np.diff([t for _, t, _, _ in of_one]) * 1e-9
        assert len(of_one) > 10 and np.ptp(spacing[4:]) < 0.06, name
    assert {ground for _, _, ground, _ in by_walker["neighbour"]} == {"asphalt"}
    for name in ("own_body", "companion"):
        grounds = [ground for _, _, ground, _ in by_walker[name]]
        lawn = grounds.index("grass")
        assert lawn > 4 and set(grounds[:lawn]) == {"asphalt"} and set(grounds[lawn:]) == {"grass"}
        places = np.array([place for _, _, _, place in by_walker[name]])
        # The lawn begins at z = -44; a foot comes down half a step before the body.
        assert places[lawn:, 2].max() < -43.4 and places[:lawn, 2].min() > -45.0

    report = write_sound(RunSettings(file), tmp_path / "walk.wav", 7.5)
    heard = sorted((row.t_ns, row.sound.split(":")[0]) for row in report.rows if row.sound.startswith("steps"))
    sound_of = {"asphalt": "steps", "grass": "steps_on_grass"}
    assert heard == sorted((t, sound_of[ground]) for _, t, ground, _ in steps)
    assert max(row.latency_ms for row in report.rows) < 20.0

    mix, dull, bright = read_file(str(report.file)).mean(axis=1), [], []
    onsets = {(row.t_ns, row.sound.split(":")[0]): row.onset_sample for row in report.rows}
    for _, t, ground, _ in by_walker["own_body"]:
        at = onsets[t, sound_of[ground]]
        spectrum = np.abs(np.fft.rfft(mix[at : at + 9600] * np.hanning(9600))) ** 2
        # The rustle of blades, 2.4 to 8 kHz, against the knock of hard ground, 0.3 to 1.5 kHz: steps on both have grit.
        (bright if ground == "grass" else dull).append(spectrum[480:1600].sum() / spectrum[60:300].sum())
    assert min(bright) > 1.3 * max(dull), "the companion may tread at the same time, on the other ground"
    assert np.median(bright) > 6.0 * np.median(dull)


def test_who_moves_the_hand_aside_stands_looks_about_and_hears_the_others(tmp_path: Path) -> None:
    file = changed(tmp_path)
    file.write_text(file.read_text().replace("[0.0, 1.3, -0.6]", "[0.08, 1.2, -0.6]"))  # where the hand goes
    steps, gaze = walked(file, 6.0)
    assert {name for name, _, _, _ in steps} == {"neighbour", "stroller"}
    assert math.atan2(gaze[0], -gaze[2]) == pytest.approx(8.0 * 0.08, abs=0.15), "to the right of north"


def test_by_hand_an_obstacle_is_touched_with_the_foot_before_the_way_opens() -> None:
    """The simulated hand closes three times; the foot meets the box, which is passed once it sank."""
    passed, foot = None, 0.0
    with mimics.open("city_walk", record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        find = session.world.find
        for _ in range(60 * 16):
            session.step()
            along = 46.0 - float(find("person").world_matrix()[2, 3])
            if along < 4.7:
                foot = max(foot, 46.0 - float(find("own_body/rightFoot").world_matrix()[2, 3]) - along)
            if passed is None and along > 4.8:
                passed = float(find("obstacle_box").world_matrix()[1, 3])
    assert passed is not None and passed < -0.4
    assert session.task["taps"] == 3.0 and session.task["walked_m"] > 5.0
    assert 0.15 < foot < 0.6


def test_the_whole_walk_ends_at_the_church(tmp_path: Path) -> None:
    file = changed(tmp_path, 128.1)
    document = json.loads(file.read_text())
    document["task"]["goals"] = [{"kind": "walked", "metres": 50.0}]
    file.write_text(json.dumps(document))
    with mimics.open(file, record=False) as session:
        session.step_until(lambda s: s.orders.result is not None)
        result, eyes = session.orders.result, session.world.cameras[0].world_from_eye
    assert result is not None and result.outcome == "finished"
    assert 0.9 < result.performance < 1.0, "the score is the mean speed, which begins at rest"
    np.testing.assert_allclose(eyes[:3, 3], (61.4, 1.74, -100.0), atol=0.2)
    assert -eyes[0, 2] > 0.98 * np.hypot(eyes[0, 2], eyes[2, 2]), "they look east, at the church"


def test_the_mouse_moves_the_hand_before_the_person_wherever_they_are() -> None:
    frame = mat.compose(np.array([30.0, 0.1, -91.0]), quat.about_axis((0.0, 1.0, 0.0), -1.2))
    ray = ((0.0, 1.6, 0.0), (0.1, -0.3, -1.0))
    origin, direction = (frame[:3, :3] @ vector for vector in ray)
    moved = tuple(origin + frame[:3, 3]), tuple(direction)
    for given, wanted in zip(ray_to_the_hand(moved, frame), ray, strict=True):
        np.testing.assert_allclose(given, wanted, atol=1e-12)
    assert ray_to_the_hand(moved, None) is moved and ray_to_the_hand(None, frame) is None


def test_a_path_is_followed_by_its_length() -> None:
    corner = GroundPath(WalkingPath(((0.0, 0.0, 0.0), (0.0, 0.0, -10.0), (10.0, 1.0, -10.0)), ("asphalt", "grass")))
    np.testing.assert_allclose(corner.at(4.0), (0.0, 0.0, -4.0))
    np.testing.assert_allclose(corner.at(10.0 + 0.5 * math.sqrt(101.0)), (5.0, 0.5, -10.0))
    np.testing.assert_allclose(corner.at(1e6), (10.0, 1.0, -10.0))
    assert (corner.ground(-1.0), corner.ground(9.9), corner.ground(10.1), corner.ground(99.0)) == (
        *("asphalt",) * 2,
        *("grass",) * 2,
    )
    headings = [corner.heading(s) for s in (0.0, 8.0, 9.0, 10.0, 11.0, 20.0)]
    assert headings[0] == pytest.approx(math.pi) and headings[-1] == pytest.approx(math.pi / 2, abs=1e-3)
    assert headings == sorted(headings, reverse=True), "one turn, begun before the corner"
    ring = GroundPath(WalkingPath(((0.0, 0.0, 0.0), (0.0, 0.0, 4.0), (4.0, 0.0, 4.0), (4.0, 0.0, 0.0)), (), True))
    np.testing.assert_allclose(ring.at(17.0), ring.at(1.0))
    assert ring.heading(1.0) == pytest.approx(0.0) and ring.length == 16.0


@pytest.mark.parametrize(
    ("components", "pointer", "what"),
    [
        ({"route": {"walking_path": {"points": [[0, 0, 0], [0, 0, 0]]}}}, "points/1", "where the corner before it is"),
        (
            {"route": {"walking_path": {"points": [[0, 0, 0], [0, 0, 1]], "grounds": ["a", "b"]}}},
            "grounds",
            "2 grounds for 1 leg",
        ),
        ({"neighbour": {"path_walker": {"path": "rout"}}}, "path", 'did you mean "route"'),
        ({"companion": {"path_walker": {"path": "route", "beside": "ego"}}}, "beside", "path_walker"),
    ],
)
def test_a_faulty_walk_is_reported(tmp_path: Path, components: Any, pointer: str, what: str) -> None:
    with pytest.raises(SceneError) as refused:
        load_checked_scene(changed(tmp_path, **components))
    issue = refused.value.issues[0]
    assert issue.pointer.endswith(pointer) and what in str(issue)


def test_a_goal_without_its_section_is_reported(tmp_path: Path) -> None:
    file = changed(tmp_path)
    document = json.loads(file.read_text())
    del document["task"]["city_walk"]
    file.write_text(json.dumps(document))
    with pytest.raises(SceneError, match="this goal needs city_walk in the task"):
        load_checked_scene(file)
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert({"points": [[0, 0, 0]]}, WalkingPath)
