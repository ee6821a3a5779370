"""The people as the builder makes them: measures of real bodies, closed surfaces, lids that close, motions."""

from __future__ import annotations

import itertools
import json
import math
import struct
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from assets.builders.avatars.build import write_figure
from assets.builders.avatars.cage import make_cage
from assets.builders.avatars.face_map import LID_LIFT
from assets.builders.avatars.face_shape import EYE_RADIUS
from assets.builders.avatars.flesh import make_flesh
from assets.builders.avatars.holding import HELD
from assets.builders.avatars.measures import TABLE, measure
from assets.builders.avatars.motions import MOTIONS
from assets.builders.avatars.person import EVERYBODY, Person
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.postures import Pose, Y
from assets.builders.avatars.skeleton import FINGERS, make_skeleton
from assets.builders.avatars.whole_person import Figure, make_figure
from mimics_app.contracts.system.resources import root
from tests.support.reference_skinning import frames_of, skin_linear

F8 = NDArray[np.float64]


@cache
def made(name: str) -> Figure:
    return make_figure(next(person for person in EVERYBODY if person.name == name), 1)


@pytest.fixture(scope="module", params=["woman_mara", "player_white"])
def figure(request: pytest.FixtureRequest) -> Figure:
    """One in a skirt with bare arms and one in shorts: every kind of part."""
    return made(request.param)


@pytest.mark.parametrize("person", EVERYBODY[:4], ids=lambda person: person.name)
def test_measures_lie_within_the_published_percentiles(person: Person) -> None:
    bones = make_skeleton(person)
    found = measure(person, bones, make_cage(person, bones, make_flesh(person, bones)))
    assert set(found) == set(TABLE)
    for name, value in found.items():
        low, high = TABLE[name].band(woman=person.body.woman)
        assert low <= value <= high, (name, value, low, high)


def test_people_differ_in_body_and_face() -> None:
    four = EVERYBODY[:4]
    assert len({person.body.stature for person in four}) == len({person.face for person in four}) == 4
    assert sum(person.body.woman for person in four) == 2
    by_name = {person.name: person for person in EVERYBODY}
    assert by_name["twin_woman"].clothes == by_name["twin_man"].clothes


def test_every_part_is_closed_and_there_are_few_enough_triangles(figure: Figure) -> None:
    near = len(figure.pieces["wisps"].triangles)  # of the finest level alone
    assert 5_000 <= sum(len(piece.triangles) for piece in figure.pieces.values()) - near <= 10_000 and near <= 1_100
    for name, piece in figure.pieces.items():
        if name in ("head", "skin"):
            continue
        assert not _open_edges([piece]), name
    assert not _open_edges([figure.pieces["head"], figure.pieces["skin"]])


def _open_edges(pieces: list[Piece]) -> set[tuple[int, int]]:
    """Edges that some triangle has and none has the other way round."""
    corners = np.concatenate([piece.places[piece.triangles].reshape(-1, 3) for piece in pieces])
    _, same = np.unique(np.round(corners, 6), axis=0, return_inverse=True)
    triangles = same.reshape(-1, 3)
    edges = [(int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3) if t[i] != t[(i + 1) % 3]]
    known = set(edges)
    return {edge for edge in edges if edge[::-1] not in known}


def test_weights_and_uvs_are_whole(figure: Figure) -> None:
    for piece in figure.pieces.values():
        assert np.allclose(piece.weights.sum(axis=1), 1.0, atol=1e-9) and piece.weights.min() >= 0.0
        assert np.allclose(np.linalg.norm(piece.normals, axis=1), 1.0, atol=1e-6)
        assert np.isfinite(piece.uvs).all() and np.isfinite(piece.shades).all()
        for steps in piece.moves.values():
            assert steps.shape == piece.places.shape and np.abs(steps).max() < 0.06


def test_lids_close_over_the_eyeballs(figure: Figure) -> None:
    head = figure.pieces["head"]
    shut = head.places + head.moves["blink"]
    for eye in figure.head.eyes:
        before = np.linalg.norm(head.places - eye, axis=1)
        rims = np.flatnonzero((np.abs(before - EYE_RADIUS - LID_LIFT) < 4e-4) & (head.places[:, 2] > eye[2] + 0.008))
        moved = rims[head.moves["blink"][rims, 1] < -0.004]
        assert len(moved) >= 3  # the middle of the upper edge
        for corner in moved:
            assert np.linalg.norm(shut[corner] - eye) >= EYE_RADIUS
            still = rims[head.moves["blink"][rims, 1] == 0.0]
            gap = np.abs(shut[still, :2] - shut[corner, :2]).max(axis=1).min()
            assert gap < 0.0015, gap


def test_gaze_meets_a_target(figure: Figure) -> None:
    """Turning an eye's joint by an angle turns the picture of its iris by the same: the eyes are rigid about it."""
    pose = Pose(figure.bones).turn("leftEye", (Y, 20.0))
    eyes = figure.pieces["eyes"]
    left = eyes.weights[:, figure.bones.index("leftEye")] == 1.0
    iris = left & (np.abs(eyes.uvs - 0.5).max(axis=1) < 1e-4)
    moved = skin_linear(eyes.places, eyes.weights, pose)
    way = moved[iris][0] - figure.head.eyes[0]
    assert abs(math.degrees(math.atan2(way[0], way[2])) - 20.0) < 1.0


@pytest.mark.parametrize("name", MOTIONS)
def test_motions_stand_on_the_ground_and_loop(name: str) -> None:
    bones, motion = make_skeleton(EVERYBODY[0]), MOTIONS[name]
    for share in np.linspace(0.0, 1.0, 9):
        turns, moves = frames_of(motion.pose(bones, float(share * motion.seconds)))
        feet = [bones.index(f"{side}Foot") for side in ("left", "right")]
        heels = [turns[foot] @ (bones.places[foot] * [1.0, 0.0, 1.0]) + moves[foot] for foot in feet]
        assert min(heel[1] for heel in heels) < 0.20
    if motion.loops:
        first, last = motion.pose(bones, 0.0), motion.pose(bones, motion.seconds)
        assert np.abs(np.abs((first.turns * last.turns).sum(axis=1)) - 1.0).max() < 1e-3
        assert np.linalg.norm(first.hips - last.hips) < 0.003


def test_idle_people_never_freeze() -> None:
    bones, motion = make_skeleton(EVERYBODY[0]), MOTIONS["idle"]
    poses = [motion.pose(bones, t) for t in np.arange(0.0, motion.seconds, 0.25)]
    for one, two in itertools.pairwise(poses):
        moved = abs(one.morphs["breathe"] - two.morphs["breathe"]) + np.abs(one.turns - two.turns).max()
        assert moved > 1e-3
    assert max(pose.morphs["blink"] for pose in (motion.pose(bones, t) for t in np.arange(0.0, 12.0, 0.02))) > 0.95


def test_the_shipped_file_is_what_the_builder_makes() -> None:
    """Numbers to a micrometre, as sines differ in their last digit between machines; levels of detail are the same."""
    name = "player_white"
    built, shipped = (
        _opened(data)
        for data in (
            write_figure(made(name), 1),
            (root() / "assets" / "models" / "avatars" / f"{name}.glb").read_bytes(),
        )
    )
    assert built[0]["nodes"] == shipped[0]["nodes"]
    assert [each["name"] for each in built[0]["animations"]] == list(MOTIONS)
    for one, two in zip(built[0]["meshes"], shipped[0]["meshes"], strict=True):
        for a, b in zip(one["primitives"], two["primitives"], strict=True):
            places = [_positions(file, part) for file, part in ((built, a), (shipped, b))]
            assert places[0].shape == places[1].shape
            assert np.abs(places[0] - places[1]).max() < 1e-6


def _opened(data: bytes) -> tuple[Any, bytes]:
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def _positions(file: tuple[Any, bytes], primitive: Any) -> F8:
    document, binary = file
    accessor = document["accessors"][primitive["attributes"]["POSITION"]]
    view = document["bufferViews"][accessor["bufferView"]]
    start, count = view["byteOffset"], accessor["count"]
    return np.frombuffer(binary, "<f4", 3 * count, start).astype(float).reshape(-1, 3)


@pytest.mark.parametrize("name", HELD)
@pytest.mark.parametrize("side", [1, -1])
def test_fingers_lie_on_what_they_hold(name: str, side: int) -> None:
    """Ends of the fingers by the chain of frames, half a finger's thickness from the object, to 3 mm."""
    bones, word = make_skeleton(EVERYBODY[1]), "left" if side > 0 else "right"
    pose, held = MOTIONS[name].pose(bones, 0.0), HELD[name]
    turns, places = pose.places()
    hand = bones.index(f"{word}Hand")
    for finger in FINGERS:
        last = bones.index(f"{word}{finger}Distal")
        end = places[last] + turns[last] @ (bones.tips[f"{word}{finger}Tip"] - bones.places[last])
        inside = turns[hand].T @ (end - places[hand]) - held.place(pose, side)
        if held.long:
            inside[2] = 0.0  # the thumb of a hand at rest points ahead, and so does what is long
        assert np.linalg.norm(inside) - held.radius == pytest.approx(0.008, abs=0.003), finger
