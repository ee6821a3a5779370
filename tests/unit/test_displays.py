"""Displays as lists of views: walls to the last digits, stereo screens by closed form, headsets by their lenses."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.commands import devices
from mimics_app.app.session.preparation import prepare
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.ports.display_choice import DISPLAY_KINDS, DisplayChoice, parse_display
from mimics_app.contracts.ports.display_port import Eye, Viewpoint
from mimics_app.maths.poses import pose_from_parts, rotation_from_vector
from mimics_app.rendering.visual.displays.desktop import DesktopDisplay
from mimics_app.rendering.visual.displays.headset import RawHeadset, seen_tangents
from mimics_app.rendering.visual.displays.headset_file import EyeSpec, HeadsetSpec, LensSpec, load_headset
from mimics_app.rendering.visual.displays.headset_session import HeadsetDisplay
from mimics_app.rendering.visual.displays.lens import distort
from mimics_app.rendering.visual.displays.off_axis import Rectangle, frustum_of
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from mimics_app.rendering.visual.displays.stereo import STEREO_KINDS, StereoDisplay
from mimics_app.rendering.visual.displays.wall_file import load_walls
from mimics_app.rendering.visual.displays.walls import WallDisplay
from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT
from mimics_app.rendering.visual.passes.hud import plane_of_views
from mimics_app.rendering.visual.view import View
from tests.support.lens import undistort

FOV = math.radians(50.0)


def random_pose(chance: np.random.Generator) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = rotation_from_vector(chance.normal(size=3))
    pose[:3, 3] = chance.normal(size=3)
    return pose


def view_of(eye: Eye) -> View:
    return View(eye.world_from_eye, eye.tangents, eye.rectangle)


def on_picture(view: View, point: np.ndarray) -> np.ndarray:
    clip = view.clip_from_world @ np.append(point, 1.0)
    return clip[:2] / clip[3]


def test_a_window_narrower_than_4_to_3_shows_as_much_to_the_sides_with_square_pixels() -> None:
    top = math.tan(0.5 * FOV)
    for size, wanted in [((1280, 720), top * 16 / 9), ((1024, 768), top * 4 / 3), ((300, 900), top * 4 / 3)]:
        (eye,) = DesktopDisplay().eyes(Viewpoint(np.eye(4), FOV), size, 0)
        left, right, bottom, above = eye.tangents
        assert (right, above) == pytest.approx((wanted, wanted * size[1] / size[0]), rel=1e-15)
        assert (left, bottom) == (-right, -above)
        for kind, shown in [("sbs-half", size), ("tb", size), ("sbs", (2 * size[0], size[1]))]:
            for eye in StereoDisplay(kind).eyes(Viewpoint(np.eye(4), FOV), shown, 0):
                left, right, _, above = eye.tangents
                assert (0.5 * (right - left), above) == pytest.approx((wanted, wanted * size[1] / size[0]), rel=1e-15)


def test_every_corner_of_a_wall_falls_on_the_picture_s_corner() -> None:
    chance = np.random.default_rng(3)
    worst = 0.0
    for _ in range(500):
        room = random_pose(chance)[:3, :3]
        width, height, away = chance.uniform(0.5, 4.0, 3)
        corner = chance.normal(size=3)
        wall = Rectangle(corner, corner + width * room[:, 0], corner + height * room[:, 1])
        inside = chance.uniform(-1.0, 2.0, 2)
        eye = corner + inside[0] * width * room[:, 0] + inside[1] * height * room[:, 1] + away * room[:, 2]
        frustum = frustum_of(wall, eye)
        view = View(frustum.pose, frustum.tangents, (0, 0, 8, 8))
        seen = np.array([on_picture(view, point) for point in wall.corners])
        worst = max(worst, np.abs(seen - [[-1, -1], [1, -1], [-1, 1], [1, 1]]).max())
        # A point anywhere on the wall falls where it is in the wall's own coordinates.
        at = chance.uniform(0, 1, 2)
        point = corner + at[0] * width * room[:, 0] + at[1] * height * room[:, 1]
        worst = max(worst, np.abs(on_picture(view, point) - (2 * at - 1)).max())
    assert worst <= 1e-12


def cave(tmp_path: Path, **more: object) -> Path:
    walls = [
        {"name": "front", "lower_left": [-1.5, 0, -1.5], "lower_right": [1.5, 0, -1.5], "upper_left": [-1.5, 3, -1.5]},
        {"name": "left", "lower_left": [-1.5, 0, 1.5], "lower_right": [-1.5, 0, -1.5], "upper_left": [-1.5, 3, 1.5]},
        {"name": "floor", "lower_left": [-1.5, 0, 1.5], "lower_right": [1.5, 0, 1.5], "upper_left": [-1.5, 0, -1.5]},
    ]
    file = tmp_path / "cave.json"
    file.write_text(json.dumps({"format": "mimics.walls/1", "walls": walls, **more}))
    return file


def test_an_edge_that_two_walls_share_is_seen_in_one_direction(tmp_path: Path) -> None:
    display = WallDisplay("cave", load_walls(cave(tmp_path, stereo=True)))
    head = pose_from_parts((0.3, 1.6, 0.2), (0.1, 0.3, 0.0, 0.95))
    display.head = lambda _: head
    camera = np.eye(4)
    camera[:3, 3] = (4.0, 1.7, -2.0)
    eyes = display.eyes(Viewpoint(camera, FOV), display.drawn_size((300, 300)), 0)
    assert [eye.name for eye in eyes] == [
        f"wall_{w}_{s}" for s in ("left", "right") for w in ("front", "left", "floor")
    ]
    for first, second in ((0, 1), (3, 4)):
        front, left = view_of(eyes[first]), view_of(eyes[second])
        np.testing.assert_allclose(front.eye_world, left.eye_world, atol=1e-12)
        for up in np.linspace(-1, 1, 9):
            _, one = front.ray(-1.0, up)
            _, other = left.ray(1.0, up)
            np.testing.assert_allclose(one / np.linalg.norm(one), other / np.linalg.norm(other), atol=1e-12)


def test_the_eyes_separation_turns_with_the_head_not_with_the_wall(tmp_path: Path) -> None:
    display = WallDisplay("cave", load_walls(cave(tmp_path, stereo=True)))
    roll = math.radians(90.0)
    display.head = lambda _: pose_from_parts((0.0, 1.7, 0.0), (0, 0, math.sin(roll / 2), math.cos(roll / 2)))
    eyes = display.eyes(Viewpoint(np.eye(4), FOV), (900, 600), 0)
    apart = eyes[3].world_from_eye[:3, 3] - eyes[0].world_from_eye[:3, 3]
    np.testing.assert_allclose(apart, [0, 0.063, 0], atol=1e-12)


def test_a_person_in_walls_stands_upright_wherever_the_camera_is_tilted_to(tmp_path: Path) -> None:
    display = WallDisplay("wall", load_walls(cave(tmp_path)))
    tilted = np.eye(4)
    tilted[:3, :3] = rotation_from_vector(np.array([-0.4, 0.0, 0.0]))
    front = display.eyes(Viewpoint(tilted, FOV), (900, 300), 0)[0]
    np.testing.assert_allclose(front.world_from_eye[:3, 1], [0, 1, 0], atol=1e-12)
    for straight in (-math.pi / 2, math.pi / 2):
        tilted[:3, :3] = rotation_from_vector(np.array([straight, 0.0, 0.0]))
        rest = Viewpoint(tilted, FOV).world_from_rest
        np.testing.assert_allclose(rest, np.eye(4), atol=1e-9)


@pytest.mark.parametrize(
    ("eye", "what"),
    [
        ((0, 1.5, -1.501), "in the wall's plane"),
        ((0, 1.5, -1.9), "behind the wall"),
        ((60.0, 1.5, -1.3), "edge-on"),
    ],
)
def test_a_wall_that_cannot_be_seen_well_says_so_and_keeps_a_finite_picture(
    tmp_path: Path, eye: tuple[float, float, float], what: str
) -> None:
    display = WallDisplay("wall", load_walls(cave(tmp_path)))
    display.head = lambda _: pose_from_parts(eye, (0, 0, 0, 1))
    for _ in range(2):
        view = view_of(display.eyes(Viewpoint(np.eye(4), FOV), (900, 300), 0)[0])
        assert np.isfinite(view.clip_from_world).all()
    reported = display.take_faults()
    assert [line for line in reported if "front" in line and what in line]
    assert display.take_faults() == []


@pytest.mark.parametrize(
    ("change", "pointer", "what"),
    [
        ({"upper_left": [-1.2, 3, -1.5]}, "/walls/0", "not at right angles"),
        ({"lower_right": [-1.5, 0, -1.5]}, "/walls/0", "shorter"),
        ({"name": "left"}, "/walls/1/name", "another wall"),
        ({"name": "a/b"}, "/walls/0/name", ""),
        ({"upper_left": [0, 1]}, "/walls/0/upper_left", ""),
    ],
)
def test_a_wrong_wall_is_one_clear_error(tmp_path: Path, change: dict, pointer: str, what: str) -> None:
    file = cave(tmp_path)
    document = json.loads(file.read_text())
    document["walls"][0] |= change
    file.write_text(json.dumps(document))
    with pytest.raises(SceneError) as caught:
        load_walls(file)
    assert [issue for issue in caught.value.issues if issue.pointer == pointer and what in issue.what]


def test_a_session_reads_the_display_s_file_before_anything_begins(tmp_path: Path) -> None:
    """Not when the first frame is due: by then a subject has begun a session that is lost."""
    (tmp_path / "walls.json").write_text('{"format": "mimics.walls/1", "walls": []}')
    scene = Path(__file__).parents[2] / "scenes" / "wavy_tunnel.json"
    for display in (f"cave:{tmp_path / 'walls.json'}", f"hmd:{tmp_path / 'none.json'}"):
        with pytest.raises(SceneError) as caught:
            prepare(RunSettings(scene, display=display), live=False)
        assert display.endswith(caught.value.issues[0].file)


@pytest.mark.parametrize("depth", [0.5, 1.0, 2.0, 4.0, 50.0, 1e9])
@pytest.mark.parametrize("kind", STEREO_KINDS)
def test_parallax_follows_the_closed_form_and_is_never_vertical(kind: str, depth: float) -> None:
    display = StereoDisplay(kind, ipd=0.063, screen_distance=2.0)
    camera = random_pose(np.random.default_rng(5))
    drawn = display.drawn_size((640, 480))
    left, right = display.eyes(Viewpoint(camera, FOV), drawn, 0)
    point = camera @ [0.1 * depth, -0.07 * depth, -depth, 1.0]
    seen = [on_picture(view_of(eye), point[:3]) for eye in (left, right)]
    width = 2.0 * (left.tangents[1] - left.tangents[0])  # of the screen at 2 m
    found = 0.5 * width * (seen[1][0] - seen[0][0])
    assert abs(found - 0.063 * (depth - 2.0) / depth) <= 1e-9  # e (Z - Z0) / Z
    assert abs(seen[1][1] - seen[0][1]) <= 1e-9


def test_swapped_eyes_take_each_other_s_place() -> None:
    plain, swapped = (StereoDisplay("sbs", swap=swap).eyes(Viewpoint(np.eye(4), FOV), (640, 480), 0) for swap in (0, 1))
    assert [eye.name for eye in swapped] == ["left", "right"]
    assert [eye.rectangle for eye in swapped] == [eye.rectangle for eye in plain][::-1]


@pytest.mark.parametrize("k", [(0.2, 0.05), (0.0, 0.0), (1.0, 0.5), (0.0, 2.0)])
def test_the_inverse_of_a_lens_gives_back_where_it_was(k: tuple[float, float]) -> None:
    at = np.random.default_rng(1).uniform(-1.2, 1.2, (4000, 2))
    at[0] = 0.0
    assert np.abs(undistort(distort(at, k), k) - at).max() <= 1e-9


def test_a_headset_s_drawn_picture_holds_all_that_its_panels_show() -> None:
    spec = HeadsetSpec()
    eye = spec.left
    left, right, bottom, top = seen_tangents(eye)
    across = np.stack(np.meshgrid(np.linspace(*eye.tangents[:2], 21), np.linspace(*eye.tangents[2:], 21)), axis=-1)
    for k in (eye.lens.red, eye.lens.green, eye.lens.blue):
        seen = distort(across, k)
        assert (seen >= np.array([left, bottom]) - 1e-12).all()
        assert (seen <= np.array([right, top]) + 1e-12).all()


def test_canted_panels_keep_their_whole_pose(tmp_path: Path) -> None:
    canted = [0.0, math.sin(0.05), 0.0, math.cos(0.05)]
    file = tmp_path / "hmd.json"
    left = {"tangents": [-1.2, 0.8, -1, 1], "position": [-0.03, 0, 0], "rotation": canted}
    file.write_text(json.dumps({"format": "mimics.headset/1", "left": left}))
    display = RawHeadset(load_headset(file))
    head = pose_from_parts((0.1, 0.0, 0.2), (0.0, 0.3, 0.0, 0.95))
    display.head = lambda _: head
    eye = display.eyes(Viewpoint(np.eye(4), FOV), (400, 200), 0)[0]
    np.testing.assert_allclose(
        np.linalg.inv(head) @ eye.world_from_eye, pose_from_parts((-0.03, 0, 0), canted), atol=1e-12
    )


def test_wrong_headsets_are_refused_with_their_place(tmp_path: Path) -> None:
    file = tmp_path / "hmd.json"
    bad = {"tangents": [1, -1, -1, 1], "position": [0, 0, 0], "rotation": [0, 0, 0, 2]}
    file.write_text(json.dumps({"format": "mimics.headset/1", "left": bad, "poses": [{"t": 1}, {"t": 1}]}))
    with pytest.raises(SceneError) as caught:
        load_headset(file)
    assert {issue.pointer for issue in caught.value.issues} == {"/left/tangents", "/left/rotation", "/poses/1/t"}


def test_every_kind_of_display_is_read_and_others_are_not() -> None:
    for kind, of in DISPLAY_KINDS.items():
        text = kind if of.file != "must" else f"{kind}:walls.json"
        assert str(parse_display(text)) == text
    assert parse_display("cave:a:b.json") == DisplayChoice("cave", "a:b.json")
    for wrong in ("cave", "wall:", "sbs:x.json", "sbss", ""):
        with pytest.raises(UsageError):
            parse_display(wrong)


def test_lens_coefficients_are_never_such_that_a_lens_folds_over() -> None:
    # k >= 0 in the file: the radius grows throughout, so that the inverse is unique.
    r = np.linspace(0.0, 2.0, 400)[:, None] * [1.0, 0.0]
    lens = LensSpec()
    for k in (lens.red, lens.green, lens.blue):
        assert (np.diff(distort(r, k)[:, 0]) > 0.0).all()


def test_figures_in_a_headset_are_large_near_the_middle_and_comfortably_far() -> None:
    """The smallest word of a card takes more than 1.3 degrees; nothing is farther than 32 degrees from the middle."""
    spec = HeadsetSpec()
    eyes = HeadsetDisplay("sim-hmd", SimulatedRuntime(spec))
    eyes.begin_frame(0)
    views = [view_of(eye) for eye in eyes.eyes(Viewpoint(np.eye(4), FOV), (1600, 800), 0)]
    plane = plane_of_views(views, 1.0)
    away = -(plane.origin_world[2])
    assert away >= 1.28  # both eyes turn in for it by no more than a degree beyond what a screen asks
    unit = np.linalg.norm(plane.up_world) / plane.canvas_height / away
    assert math.degrees(math.atan(17.0 * unit)) >= 1.3
    corners = [plane.origin_world + a * plane.right_world + b * plane.up_world for a in (0, 1) for b in (0, 1)]
    assert all(abs(x) <= away * math.tan(math.radians(32.0)) for x, _, _ in corners)
    screen = [view_of(eye) for eye in StereoDisplay("sbs").eyes(Viewpoint(np.eye(4), FOV), (1600, 800), 0)]
    assert plane_of_views(screen, 1.0).canvas_height == CANVAS_HEIGHT


def test_figures_stand_straight_before_a_headset_whose_panels_look_outwards() -> None:
    half = math.radians(2.5)
    left, right = (
        EyeSpec(
            tangents=(-1.1, 0.8, -1.0, 0.9) if side < 0 else (-0.8, 1.1, -1.0, 0.9),
            position=(side * 0.0315, 0.0, 0.0),
            rotation=(0.0, -side * math.sin(half), 0.0, math.cos(half)),
        )
        for side in (-1.0, 1.0)
    )
    eyes = HeadsetDisplay("sim-hmd", SimulatedRuntime(HeadsetSpec(left=left, right=right)))
    eyes.begin_frame(0)
    plane = plane_of_views([view_of(eye) for eye in eyes.eyes(Viewpoint(np.eye(4), FOV), (1600, 800), 0)], 1.4)
    np.testing.assert_allclose(plane.right_world[1:], 0.0, atol=1e-12)
    np.testing.assert_allclose(plane.up_world[::2], 0.0, atol=1e-12)
    np.testing.assert_allclose(plane.origin_world[0] + 0.5 * plane.right_world[0], 0.0, atol=1e-12)


def test_every_kind_of_display_is_described_and_listed_so() -> None:
    rows = {row["name"]: row for row in devices._display_kinds({"ok": True})}
    assert {name: rows[name]["about"] for name in DISPLAY_KINDS} == {n: k.caption for n, k in DISPLAY_KINDS.items()}
    assert len({kind.caption for kind in DISPLAY_KINDS.values()}) == len(DISPLAY_KINDS)
    assert devices._line(rows["wall"]["write"], rows["wall"]) == f"{'wall:FILE':<24} a wall seen by a tracked head"
