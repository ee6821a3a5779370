"""The viewer's orbit and selection, and meshes without normals: geometry with closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.app.picture.orbit_camera import OrbitCamera
from mimics_app.app.viewer.selection import Selection, axis_under, drag_offset, gizmo_arrows
from mimics_app.app.viewer.shown import Shown, open_shown
from mimics_app.contracts.errors import SceneError
from mimics_app.world.content.extent import world_extent
from mimics_app.world.content.meshes.primitives import box, sphere
from mimics_app.world.content.meshes.shading_groups import shaded_mesh
from mimics_app.world.content.world import World

SIZE = (1280, 720)
EXTENT = (np.array([-1.0, 0.0, -2.0]), np.array([1.0, 1.0, 2.0]))


def project(orbit: OrbitCamera, point: np.ndarray, size: tuple[int, int] = SIZE) -> np.ndarray:
    x, y, _, w = orbit.view(size).clip_from_world @ [*point, 1.0]
    return np.array([x, y]) / w


@pytest.mark.parametrize("size", [SIZE, (300, 900)])
def test_a_framed_box_is_seen_whole_from_every_side(size):
    orbit = OrbitCamera()
    orbit.frame(EXTENT, size)
    corners = [np.where(mask, EXTENT[0], EXTENT[1]) for mask in np.ndindex(2, 2, 2)]
    for _ in range(12):
        assert np.abs([project(orbit, corner, size) for corner in corners]).max() < 1.0
        orbit.orbit(100.0, 7.0)


@pytest.mark.parametrize("size", [SIZE, (300, 900)])
def test_panning_keeps_the_target_under_the_pointer(size):
    orbit = OrbitCamera()
    orbit.frame(EXTENT, size)
    before = orbit.target.copy()
    orbit.pan(64.0, -36.0, size)
    assert project(orbit, before, size) == pytest.approx([128.0 / size[0], -72.0 / size[1]], abs=1e-9)


def test_a_look_round_leaves_the_eye_where_it_is_and_never_tips_over():
    orbit = OrbitCamera()
    here = orbit.position
    orbit.rotate_in_place(333.0, 4000.0)
    assert orbit.position == pytest.approx(here, abs=1e-12)
    assert orbit.pose[1, 1] > 0.0, "its up is never down"


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_dragging_along_an_axis_follows_the_pointer_and_stays_on_it(axis):
    orbit = OrbitCamera()
    orbit.frame(EXTENT, SIZE)
    grabbed, wanted = np.array([0.3, 0.5, 0.2]), np.zeros(3)
    wanted[axis] = 0.4
    offset = drag_offset(grabbed, orbit.view(SIZE).ray(*project(orbit, grabbed + wanted)), orbit.view(SIZE), axis)
    assert offset == pytest.approx(wanted, abs=1e-9)


def test_dragging_over_the_floor_stays_at_its_height_and_flat_views_drag_across():
    orbit = OrbitCamera()
    orbit.frame(EXTENT, SIZE)
    grabbed = np.array([0.3, 0.5, 0.2])
    offset = drag_offset(grabbed, orbit.view(SIZE).ray(0.2, -0.1), orbit.view(SIZE), None)
    assert offset[1] == pytest.approx(0.0, abs=1e-12) and np.linalg.norm(offset) > 0.01
    assert project(orbit, grabbed + offset) == pytest.approx([0.2, -0.1], abs=1e-9)
    orbit.pitch = 0.01
    offset = drag_offset(grabbed, orbit.view(SIZE).ray(0.2, -0.1), orbit.view(SIZE), None)
    assert offset @ orbit.backward == pytest.approx(0.0, abs=1e-9) and abs(offset[1]) > 0.01


@pytest.mark.parametrize("axis", [0, None])
def test_a_ray_along_the_axis_or_the_floor_moves_nothing(axis):
    orbit = OrbitCamera()
    orbit.frame(EXTENT, SIZE)
    ray = (orbit.position, np.array([1.0, 0.0, 0.0]))
    assert drag_offset(np.zeros(3), ray, orbit.view(SIZE), axis) == pytest.approx(np.zeros(3), abs=0.0)


def test_a_hand_moves_what_hangs_on_a_turned_and_scaled_parent_and_puts_it_back():
    world = World()
    world.replace_mesh("box", box(0.5, 0.5, 0.5))
    stand = world.root.create_child("model", orientation=(0.0, np.sin(0.4), 0.0, np.cos(0.4)), scale=(2.0, 2.0, 2.0))
    stand.create_child("thing").create_entity("box")
    world.update()
    orbit, selection = OrbitCamera(), Selection(Shown(path=None, world=world, stand=stand))
    orbit.frame(world_extent(world), SIZE)
    assert selection.choose(orbit.view(SIZE).ray(0.0, 0.0)).name == "model/thing" or selection.chosen.name == "thing"
    selection.axis = 0
    assert selection.grab(orbit.view(SIZE).ray(0.0, 0.0), orbit.view(SIZE))
    selection.drag(orbit.view(SIZE).ray(0.3, 0.0), orbit.view(SIZE))
    selection.release()
    world.update()
    moved = selection.chosen.world_matrix()[:3, 3]
    assert moved[0] > 0.05 and moved[1:] == pytest.approx([0.0, 0.0], abs=2e-4)  # rounded to a tenth of a millimetre
    assert selection.undo() and not selection.undo()
    assert selection.chosen.position == pytest.approx(np.zeros(3), abs=0.0)
    assert selection.choose(orbit.view(SIZE).ray(0.99, 0.99)) is None and not selection.grab(
        orbit.view(SIZE).ray(0.0, 0.0), orbit.view(SIZE)
    )


def soup(mesh) -> tuple[np.ndarray, np.ndarray]:
    """Triangles that share no corner, as an STL file has them."""
    corners = mesh.positions[mesh.indices].astype(float)
    return corners, np.arange(len(corners)).reshape(-1, 3)


def test_a_soup_of_a_cube_gets_creased_normals_and_one_of_a_ball_smooth_ones():
    cube = shaded_mesh(*soup(box(1.0, 1.0, 1.0)))
    assert len(cube.positions) == 24, "four corners for each of six faces"
    assert np.abs(cube.normals).max(axis=1) == pytest.approx(np.ones(24), abs=1e-6)
    ball = shaded_mesh(*soup(sphere(1.0, 32)))
    out = np.einsum("ij,ij->i", ball.normals.astype(float), ball.positions.astype(float))
    assert out.min() > 0.99
    assert len(ball.positions) < 0.3 * ball.indices.size


def test_degenerate_triangles_are_left_out():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]])
    mesh = shaded_mesh(points, np.array([[0, 1, 2], [0, 1, 3], [1, 1, 2]]))
    assert mesh.triangle_count == 1
    assert mesh.normals == pytest.approx(np.tile([0.0, 0.0, 1.0], (3, 1)))


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off"])
def test_mesh_files_are_shown_and_damaged_ones_named(tmp_path, suffix):
    import trimesh

    file = tmp_path / f"thing.{suffix}"
    trimesh.creation.box((1.0, 2.0, 3.0)).export(file)
    shown = open_shown(file, "z")
    assert shown.extent[1] - shown.extent[0] == pytest.approx([1.0, 3.0, 2.0], abs=1e-6)
    assert "12 triangles" in shown.size
    file.write_bytes(b"\x00\xff nothing of the kind")
    with pytest.raises(SceneError) as caught:
        open_shown(file)
    assert caught.value.issues[0].file == str(file)


def test_errors_of_a_reader_are_not_told_as_faults_of_a_file(tmp_path):
    """A PLY file cut off in its header: trimesh ends with "list index out of range"."""
    file = tmp_path / "cut.ply"
    file.write_text("ply\nformat ascii 1.0\n")
    with pytest.raises(SceneError) as caught:
        open_shown(file)
    assert caught.value.issues[0].what == "is damaged or not a PLY file"


@pytest.mark.parametrize("far", ["1e300", "nan", "1e20"])
def test_corners_that_are_nowhere_are_named(tmp_path, far):
    file = tmp_path / "far.obj"
    file.write_text(f"v 0 0 0\nv 1 0 0\nv 0 {far} 0\nf 1 2 3\n")
    with pytest.raises(SceneError, match="has vertices or indices out of range"):
        open_shown(file)


def test_an_obj_file_keeps_its_material_file_and_words_that_are_no_utf8(tmp_path):
    (tmp_path / "m.mtl").write_text("newmtl red\nKd 1.0 0.0 0.0\n")
    text = "# caf\xe9\nmtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    file = tmp_path / "t.obj"
    file.write_bytes(text.encode("latin-1"))
    shown = open_shown(file)
    assert "1 triangle, 1 part" in shown.size
    (colour,) = [m.base_colour for name, m in shown.world.materials.items() if name.startswith("t#")]
    assert colour == pytest.approx((1.0, 0.0, 0.0, 1.0))


@pytest.mark.parametrize("seed", range(4))
def test_spoiled_mesh_files_are_read_or_refused_in_one_line(tmp_path, seed, capfd):
    """Cut off, bytes changed, bytes put in: no other error, no words of a library, no hang."""
    import trimesh

    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=1)
    for suffix in ("stl", "obj", "ply", "off"):
        file = tmp_path / f"a.{suffix}"
        ball.export(file)
        whole = file.read_bytes()
        for _ in range(8):
            data = bytearray(whole[: rng.integers(1, len(whole))] if rng.random() < 0.3 else whole)
            for place in rng.integers(0, len(data), rng.integers(0, 12)):
                data[place] = rng.integers(256)
            file.write_bytes(bytes(data))
            try:
                assert open_shown(file).size
            except SceneError as error:
                assert len(error.issues) == 1 and "\n" not in str(error) and "No module" not in str(error)
    assert capfd.readouterr() == ("", "")


def test_a_file_of_no_kind_and_one_that_is_not_there_are_named(tmp_path):
    with pytest.raises(SceneError, match="unsupported file type"):
        open_shown(tmp_path / "a.max")
    with pytest.raises(SceneError, match=r"missing\.stl"):
        open_shown(tmp_path / "missing.stl")


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_an_arrow_is_grabbed_where_it_is_drawn_and_moves_along_itself(axis):
    orbit = OrbitCamera()
    orbit.frame(EXTENT, SIZE)
    view, place = orbit.view(SIZE), np.array([0.3, 0.5, 0.2])
    arrow = gizmo_arrows(place, view, None)[axis]
    assert axis_under(place, view.ray(*project(orbit, place + 0.7 * arrow.vector)), view) == axis
    assert axis_under(place, view.ray(*project(orbit, place + 2.0 * arrow.vector)), view) is None
    # Twenty pixels beside it, as the screen has it, it is not.
    half = np.array(SIZE) / 2.0
    way = (project(orbit, place + arrow.vector) - project(orbit, place)) * half
    aside = 20.0 * np.array([-way[1], way[0]]) / np.linalg.norm(way)
    beside = project(orbit, place + 0.7 * arrow.vector) + aside / half
    assert axis_under(place, view.ray(*beside), view) != axis
    faint = [each.tint[3] for each in gizmo_arrows(place, view, axis)]
    assert faint[axis] == 1.0 and sorted(faint)[1] < 0.5


def test_arrows_look_equally_long_from_near_and_far():
    lengths = []
    for distance in (1.0, 30.0):
        orbit = OrbitCamera()
        orbit.distance = distance
        ends = [
            project(orbit, arrow.origin + arrow.vector) for arrow in gizmo_arrows(orbit.target, orbit.view(SIZE), None)
        ]
        lengths.append(ends[1][1])
    # The ends of arrows are nearer or farther than their feet: equal up to perspective, which does not change either.
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-9)
