"""The scene graph: structure at once, rows at the frame's end, nothing computed that was not touched."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.maths import mat, quat
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.world import World
from mimics_app.world.graph.entity_ids import EntityId, StaleHandleError

EPS = np.finfo(float).eps


def triangle():
    return MeshData(np.eye(3, dtype="f4"), np.eye(3, dtype="f4"), np.arange(3, dtype="u4"))


def matrix_of(world, node):
    return world.transforms.world[world.transforms.row(node.index)]


def assert_sorted(world):
    parents = world.transforms.parent_rows
    assert (parents < np.arange(len(parents))).all()
    for row, index in enumerate(world.transforms.entities.tolist()):
        above = world.graph.hierarchy.parent(index)
        assert (parents[row] == -1) if above < 0 else (world.transforms.entities[parents[row]] == above)


def test_world_matrix_is_the_product_down_the_branch():
    world = World()
    a = world.create_node("a")
    b = a.create_child("b", (1, 2, 3), quat.about_axis((1, 1, 0), 0.4), (2, 2, 2))
    c = b.create_child("c", (0, 0, -1), quat.about_axis((0, 1, 0), -1.0))
    a.set_orientation(quat.about_axis((0, 0, 1), 1.1))
    world.update()
    locals_ = [mat.compose(node.position, node.orientation, node.local_scale) for node in (a, b, c)]
    assert matrix_of(world, c) == pytest.approx(locals_[0] @ locals_[1] @ locals_[2], abs=20 * EPS)


def test_only_touched_branches_are_computed_again():
    world = World()
    branches = [world.create_node(f"branch{i}") for i in range(10)]
    for branch in branches:
        for _ in range(9):
            branch.create_child()
    world.update()
    branches[3].translate((1, 0, 0))
    assert world.update() == 10
    touched = {branches[3].index, *(child.index for child in branches[3].children)}
    assert set(world.transforms.entities[world.transforms.changed.astype(bool)].tolist()) == touched
    assert world.update() == 0
    assert not world.transforms.changed.any()


def test_an_untouched_row_is_not_rewritten_even_with_the_same_value():
    world = World()
    still, moving = world.create_node("still"), world.create_node("moving")
    world.update()
    matrix_of(world, still)[0, 3] = 42.0  # a planted mark: a rewrite would wipe it out
    moving.translate((1, 0, 0))
    world.update()
    assert matrix_of(world, still)[0, 3] == 42.0


def test_a_child_attached_to_a_later_row_is_sorted_behind_it_at_the_frames_end():
    world = World()
    early, late = world.create_node("early"), world.create_node("late")
    late.set_position((5, 0, 0))
    world.update()
    late.attach(early)
    assert early.parent == late  # structure at once
    assert early.world_matrix()[0, 3] == 5.0  # and what is requested by hand is up to date
    world.update()
    assert_sorted(world)
    assert matrix_of(world, early)[0, 3] == 5.0


@settings(max_examples=60)
@given(st.lists(st.tuples(st.sampled_from("carmd"), st.integers(0, 30), st.integers(0, 30)), max_size=40))
def test_any_sequence_of_edits_leaves_rows_sorted_and_matrices_right(edits):
    world = World()
    nodes = [world.create_node()]
    for what, i, j in edits:
        nodes = [node for node in nodes if node.is_alive] or [world.create_node()]
        one, other = nodes[i % len(nodes)], nodes[j % len(nodes)]
        if what == "c":
            nodes.append(one.create_child(position=(i, j, 1)))
        elif what == "a" and not world.graph.hierarchy.is_inside(one.index, other.index):
            one.attach(other)
        elif what == "r":
            one.remove()
        elif what == "m":
            one.translate((1, 0, 0))
        elif what == "d":
            one.detach()
        if i % 3 == 0:
            world.update()
            assert_sorted(world)
    world.update()
    assert_sorted(world)
    for node in nodes:
        if node.is_alive:
            chain, index = np.zeros(3), node.index
            while index >= 0:
                chain += world.transforms.translation(index)
                index = world.graph.hierarchy.parent(index)
            assert matrix_of(world, node)[:3, 3].tolist() == chain.tolist()


def test_hanging_a_node_on_its_own_branch_is_refused():
    world = World()
    a = world.create_node("a")
    b = a.create_child("b").create_child("c")
    for target in (a, b):
        with pytest.raises(ValueError, match="cannot be moved below itself"):
            target.attach(a)
    assert b.parent is not None


def test_the_root_cannot_be_moved_or_removed():
    world = World()
    node = world.create_node()
    for edit in (world.root.remove, world.root.detach, lambda: node.attach(world.root)):
        with pytest.raises(ValueError, match="root"):
            edit()


def test_a_removed_nodes_handle_is_stale_also_when_its_index_lives_again():
    world = World()
    old = world.create_node("old")
    child = old.create_child("child")
    old.remove()
    assert old.is_alive  # until the frame's end
    world.update()
    new = [world.create_node(f"new{i}") for i in range(2)]
    assert {node.id.index for node in new} == {old.id.index, child.id.index}
    for stale in (old, child):
        assert not stale.is_alive
        with pytest.raises(StaleHandleError, match="was removed"):
            _ = stale.position
    assert all(node.is_alive for node in new)
    assert old not in new


def test_removing_a_branch_and_a_node_of_it_in_one_frame_removes_each_once():
    world = World()
    top = world.create_node("top")
    leaf = top.create_child("leaf")
    alive = len(world.graph.store)
    leaf.remove()
    top.remove()
    leaf.remove()
    world.update()
    assert len(world.graph.store) == alive - 2
    assert "top" not in world
    assert "leaf" not in world


def test_a_detached_branch_is_unseen_and_comes_back_as_it_was():
    world = World()
    world.meshes["m"] = triangle()
    top = world.create_node("top")
    leaf = top.create_child("leaf", (1, 0, 0))
    leaf.create_entity("m")
    leaf.create_light("point")
    world.update()
    top.detach()
    world.update()
    assert top.parent is None
    assert world.subentities().visible.tolist() == [0]
    assert world.lights == []
    world.root.attach(top)
    world.update()
    assert world.subentities().visible.tolist() == [1]
    assert world.lights[0].position_world.tolist() == [1, 0, 0]


def test_hiding_a_node_hides_what_hangs_on_it_and_keeps_their_own_switch():
    world = World()
    world.meshes["m"] = triangle()
    top = world.create_node("top")
    nodes = [top.create_child(), top.create_child()]
    parts = [node.create_entity("m").subentities[0] for node in nodes]
    parts[1].visible = False
    top.visible = False
    world.update()
    assert world.subentities().visible.tolist() == [0, 0]
    top.visible = True
    world.update()
    assert world.subentities().visible.tolist() == [1, 0]


def test_the_render_list_changes_its_revision_with_structure_and_material_only():
    world = World()
    world.meshes["m"] = triangle()
    node = world.create_node()
    body = node.create_entity("m")
    world.update()
    first = world.subentities().revision
    node.translate((1, 0, 0))
    body.subentities[0].visible = False
    world.update()
    assert world.subentities().revision == first
    body.subentities[0].material = "default"
    world.update()
    assert world.subentities().revision > first


def test_rows_of_bodies_follow_a_removal_before_them():
    world = World()
    world.meshes |= {"m": triangle(), "n": triangle()}
    nodes = [world.create_node(str(i)) for i in range(4)]
    bodies = [node.show([("m", "default"), ("n", "default")]) for node in nodes]
    nodes[1].remove()
    world.update()
    listed = world.subentities()
    assert listed.mesh == ["m", "n"] * 3
    assert world.transforms.entities[listed.row].tolist() == [nodes[i].index for i in (0, 0, 2, 2, 3, 3)]
    assert bodies[3].first_row == 4
    assert [part.mesh for part in bodies[2].subentities] == ["m", "n"]


def test_unknown_names_are_answered_with_the_nearest():
    world = World()
    world.meshes["sphere"] = triangle()
    node = world.create_node("ball")
    with pytest.raises(KeyError, match='did you mean "ball"'):
        world.find("bal")
    with pytest.raises(KeyError, match='did you mean "sphere"'):
        node.create_entity("spere")
    with pytest.raises(KeyError, match='did you mean "default"'):
        node.create_entity("sphere", "defaut")
    assert node.entity is None


def test_two_nodes_of_one_name_and_two_bodies_on_one_node_are_refused():
    world = World()
    world.meshes["m"] = triangle()
    node = world.create_node("a")
    node.create_entity("m")
    with pytest.raises(ValueError, match='named "a"'):
        world.create_node("a")
    with pytest.raises(ValueError, match="already"):
        node.create_entity("m")


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_numbers_that_are_not_finite_never_reach_the_table(bad):
    world = World()
    node = world.create_node()
    for setter, values in (
        (node.set_position, (bad, 0, 0)),
        (node.set_scale, (1, bad, 1)),
        (node.set_orientation, (0, 0, 0, bad)),
    ):
        with pytest.raises(ValueError, match=r"finite|rotation"):
            setter(values)
    world.update()
    assert np.isfinite(world.transforms.world).all()


def test_stored_orientation_is_unit_with_positive_w():
    node = World().create_node()
    node.set_orientation((0, 3, 0, -4))
    assert node.orientation == pytest.approx([0, -0.6, 0, 0.8])


def test_yaw_pitch_and_roll_turn_about_the_own_axes():
    node = World().create_node()
    node.yaw(math.pi / 2)  # left: looks along -x
    node.pitch(math.pi / 2)  # then up
    assert -node.world_matrix()[:3, 2] == pytest.approx([0, 1, 0], abs=4 * EPS)
    node.set_orientation(quat.IDENTITY)
    node.yaw(math.pi / 2)
    node.pitch(math.pi / 2, frame="parent")  # about the world's x: the view along -x stays
    assert -node.world_matrix()[:3, 2] == pytest.approx([-1, 0, 0], abs=4 * EPS)


def test_a_matrix_asked_for_within_a_frame_follows_what_was_set_above_it():
    world = World()
    arm, beside = world.create_node("arm"), world.create_node("beside")
    hand = arm.create_child(position=(0, 2, 0))
    world.update()
    beside.set_position((7, 0, 0))
    assert np.array_equal(hand.world_matrix(), matrix_of(world, hand))
    assert hand.world_matrix() is not hand.world_matrix(), "a copy"
    arm.set_position((1, 0, 0))
    assert hand.world_matrix()[:3, 3].tolist() == [1, 2, 0]
    assert matrix_of(world, hand)[:3, 3].tolist() == [0, 2, 0], "the table waits for the update"


def test_look_at_under_a_turned_parent_points_at_the_world_point():
    world = World()
    arm = world.create_node(parent=world.root)
    arm.set_orientation(quat.about_axis((1, 2, 0), 0.8))
    arm.set_position((3, 1, 0))
    head = arm.create_child(position=(0, 0.5, 0))
    head.look_at((-1, 4, 2))
    matrix = head.world_matrix()
    ahead = np.array([-1, 4, 2]) - matrix[:3, 3]
    assert -matrix[:3, 2] == pytest.approx(ahead / np.linalg.norm(ahead), abs=1e-14)


def test_bulk_setters_move_many_rows_and_normalise():
    world = World()
    nodes = [world.create_node() for _ in range(300)]  # beyond the first capacity
    rows = world.transforms.rows(np.array([node.index for node in nodes]))
    places = np.random.default_rng(0).normal(size=(300, 3))
    world.transforms.set_poses(rows, places, np.tile([0, 0, 0, -2.0], (300, 1)))
    world.update()
    assert world.transforms.world[rows][:, :3, 3].tolist() == places.tolist()
    assert nodes[7].orientation.tolist() == [0, 0, 0, 1]


def test_poses_and_scales_that_are_set_again_are_no_change():
    world = World()
    nodes = [world.create_node() for _ in range(3)]
    table = world.transforms
    rows = table.rows(np.array([node.index for node in nodes]))
    places, turns, scales = np.ones((3, 3)), np.tile([0.0, 0.6, 0.0, -1.6], (3, 1)), np.full((3, 3), 2.0)
    for move, changed in ((None, 3), (None, 0), (places, 1), (turns, 1), (scales, 1)):
        if move is not None:
            move[1, 0] += 0.5
        table.set_poses(rows, places, turns)
        table.set_scales(rows, scales)
        world.update()
        assert table.changed[rows].sum() == changed and table.changed[rows[1]] == (changed > 0)


def test_scales_of_rows_that_do_not_exist_or_are_not_finite_are_refused_and_nothing_is_set():
    world = World()
    nodes = [world.create_node() for _ in range(2)]
    table = world.transforms
    rows = table.rows(np.array([node.index for node in nodes]))
    with pytest.raises(ValueError, match="not finite"):
        table.set_scales(rows, np.array([[2.0, 2.0, 2.0], [1.0, np.nan, 1.0]]))
    with pytest.raises(ValueError, match="rows"):
        table.set_scales(np.array([0, 1_000_000]), np.full((2, 3), 2.0))
    world.update()
    assert all(np.array_equal(matrix_of(world, node), np.eye(4)) for node in nodes)


def test_a_chain_of_fifty_thousand_nodes_is_updated_moved_and_removed_without_recursion():
    world = World()
    node = top = world.create_node("top")
    for _ in range(50_000):
        node = node.create_child()
    world.create_node("other").attach(top)
    top.set_position((1, 0, 0))
    assert world.update() >= 50_001
    assert matrix_of(world, node)[0, 3] == 1.0
    top.remove()
    world.update()
    assert not node.is_alive
    assert len(world.transforms) == 3  # root, the place of detached nodes, other


def test_moving_a_camera_to_another_node_takes_its_settings_along():
    world = World()
    a, b = world.create_node("a"), world.create_node("b")
    camera = a.create_camera(0.7, 0.1, 20.0)
    b.attach(camera)
    assert a.camera is None
    assert (camera.node, camera.vertical_fov, camera.far) == (b, 0.7, 20.0)


def test_camera_pose_leaves_the_nodes_scale_out():
    world = World()
    node = world.create_node()
    node.set_scale((2, 3, 4))
    camera = node.create_camera()
    assert camera.world_from_eye[:3, :3].tolist() == np.eye(3).tolist()


def test_replacing_a_mesh_changes_its_revision_and_refuses_nonsense():
    world = World()
    world.replace_mesh("m", triangle())
    before = world.mesh_revision("m")
    world.replace_mesh("m", triangle())
    assert world.mesh_revision("m") > before
    bad = MeshData(np.eye(3, dtype="f4"), np.eye(3, dtype="f4"), np.array([0, 1, 3], "u4"))
    with pytest.raises(ValueError, match="3 points past the 3 vertices"):
        world.replace_mesh("m", bad)


def test_an_id_of_a_place_that_was_never_used_is_not_alive():
    world = World()
    node = world.create_node()
    assert not world.graph.store.is_alive(EntityId(node.index, node.id.generation + 1))


def test_poses_in_bulk_are_what_single_setters_make():
    """Also of quaternions that are long, short, or turned the long way round, under a parent that turns and scales."""
    rng = np.random.default_rng(5)
    worlds = [World(), World()]
    poses = rng.normal(size=(40, 3)), rng.normal(size=(40, 4)) * 10.0 ** rng.uniform(-9, 9, (40, 1))
    tables = []
    for number, world in enumerate(worlds):
        top = world.root.create_child("top", (1.0, -2.0, 0.5), (0.1, 0.7, -0.2, 0.4), (2.0, 0.5, -1.0))
        nodes = [top.create_child() for _ in range(40)]
        rows = world.transforms.rows(np.array([node.index for node in nodes]))
        if number == 0:
            world.transforms.set_poses(rows, *poses)
        else:
            for node, shift, turn in zip(nodes, *poses, strict=True):
                node.set_position(shift)
                node.set_orientation(turn)
        world.update()
        tables.append(world.transforms)
    assert np.abs(tables[0].world - tables[1].world).max() < 1e-14
    assert (tables[0].rotations[:, 3] >= 0.0).all()


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0, 0.0), (np.nan, 0.0, 0.0, 1.0), (1e200, 0.0, 0.0, 1e200)])
def test_bulk_poses_are_set_all_or_none(turn):
    world = World()
    nodes = [world.root.create_child() for _ in range(3)]
    rows = world.transforms.rows(np.array([node.index for node in nodes]))
    turns = np.array([[0.0, 0.0, 1.0, 0.0], turn, [1.0, 0.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match="pose 1 of 3"):
        world.transforms.set_poses(rows, np.ones((3, 3)), turns)
    assert not world.transforms.translations[rows].any()
    with pytest.raises(ValueError, match="2 translations"):
        world.transforms.set_poses(rows, np.ones((2, 3)), np.ones((3, 4)))
    with pytest.raises(ValueError, match="rows beyond"):
        world.transforms.set_poses(np.array([0, 1, 99]), np.ones((3, 3)), np.ones((3, 4)))


def test_updates_are_counted_so_that_a_reader_knows_what_it_missed():
    world = World()
    before = world.transforms.updates
    world.update()
    world.update()
    assert world.transforms.updates == before + 2


def test_what_a_light_gives_may_change_and_its_shape_may_not():
    light = World().create_node("lamp").create_light("spot")
    light.colour, light.intensity, light.casts_shadow = (1.0, 0.5, 0.25), 4.0, True
    assert (light.colour, light.intensity, light.casts_shadow) == ((1.0, 0.5, 0.25), 4.0, True)
    for name in ("range", "inner_cone", "outer_cone"):
        before = getattr(light, name)
        with pytest.raises(AttributeError):
            setattr(light, name, 0.5)
        assert getattr(light, name) == before


@pytest.mark.parametrize(
    ("setting", "value"), [("colour", (1.0, math.nan, 1.0)), ("intensity", math.nan), ("range", math.nan)]
)
def test_a_light_takes_numbers_only(setting, value):
    node = World().create_node("lamp")
    with pytest.raises(ValueError, match=f"{setting} is not a number"):
        node.create_light("spot", **{setting: value})
    assert node.light is None
    light = node.create_light("spot", range=math.inf)
    if setting != "range":
        with pytest.raises(ValueError, match=f"{setting} is not a number"):
            setattr(light, setting, value)
    assert (light.colour, light.intensity, light.range) == ((1.0, 1.0, 1.0), 1.0, math.inf)


def test_a_kind_of_light_and_the_type_of_a_name_are_checked():
    world = World()
    with pytest.raises(KeyError, match='no kind of light "sopt"; did you mean "spot"'):
        world.create_node("lamp").create_light("sopt")
    with pytest.raises(TypeError, match="a text, not 5"):
        world.create_node(5)


@pytest.mark.parametrize("where", [{"position": (math.nan, 0, 0)}, {"orientation": (0, 0, 0, 0)}, {"scale": None}])
def test_a_child_with_an_impossible_pose_does_not_stay(where):
    world = World()
    world.update()
    with pytest.raises((TypeError, ValueError)):
        world.root.create_child("hand", **where)
    world.update()
    assert "hand" not in world
    assert world.root.create_child("hand").name == "hand"
