"""Rows made from the components of a scene: what stands in the file stands in the row, in the right frame."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import (
    STATIC,
    BodyFlag,
    EffectKind,
    ForceLaw,
    ObjectIntegrator,
    ShapeKind,
    SignalSource,
    SignalTarget,
)
from mimics_app.maths.quat import about_axis, to_matrix
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.world.components.haptic_shapes import BoxSolid, Solid
from tests.support.object_scenes import CUBE, at, gltf_box, loaded, objects, thing

TURN = [0.0, 0.0, 0.5**0.5, 0.5**0.5]
"""A quarter about z."""


def matrix(q):
    R = np.zeros((3, 3))
    to_matrix(np.asarray(q, float), R)
    return R


def test_every_parameter_of_the_mask_arrives(tmp_path):
    mask = {
        "enable_translation": True,
        "enable_rotation": False,
        "enable_force_on_object": True,
        "enable_torque_on_object": False,
        "mass": 0.7,
        "gravity": [0.1, -9.81, 0.2],
        "shapes": [{"shape": "cube", "size": [0.1, 0.2, 0.3], "rounding": 0.01}],
        "stiffness": 900.0,
        "damping": 3.0,
        "initial_velocity": [0.1, 0.2, 0.3],
        "environment_translation_damping": 0.4,
        "environment_rotation_damping": 0.05,
        "friction_static": 0.6,
        "friction_dynamic": 0.4,
        "friction_stiffness": 800.0,
        "law": "hunt_crossley",
        "exponent": 1.3,
        "texture_height": 0.0005,
        "texture_length": 0.004,
        "material": "wood",
        "force_aux": [1, 2, 3],
        "torque_aux": [4, 5, 6],
        "integrator": "exact_drag",
        "sleeps": False,
        "grip": True,
        "crush_force": 9.0,
    }
    made = objects(tmp_path, at(1, 2, 3, thing("a", haptic_object=mask), rotation=TURN))
    body, shape = made.rows.bodies[0], made.rows.shapes[0]
    assert made.body_entities == made.shape_entities == ("a",)
    assert body["flags"] == BodyFlag.TRANSLATION | BodyFlag.FORCE_ON_OBJECT
    assert body["mass"] == 0.7
    assert body["inertia"] == pytest.approx(np.diag([0.13, 0.10, 0.05]) * 0.7 / 12.0)
    assert body["position"].tolist() == [1, 2, 3]
    assert body["orientation"] == pytest.approx(TURN)
    assert body["velocity"].tolist() == [0.1, 0.2, 0.3]
    assert body["gravity"].tolist() == [0.1, -9.81, 0.2]
    assert (body["damping_translation"], body["damping_rotation"]) == (0.4, 0.05)
    assert (body["force_aux"].tolist(), body["torque_aux"].tolist()) == ([1, 2, 3], [4, 5, 6])
    assert body["integrator"] == ObjectIntegrator.EXACT_DRAG
    assert (body["grip"], body["crush_force"], body["spawn"]) == (1, 9.0, 1)
    assert (shape["kind"], shape["body"], shape["enabled"], shape["law"]) == (
        ShapeKind.BOX,
        0,
        1,
        ForceLaw.HUNT_CROSSLEY,
    )
    assert shape["size"].tolist() == [0.1, 0.2, 0.3]
    wanted = ("rounding", "stiffness", "damping", "friction_static", "friction_dynamic", "friction_stiffness")
    assert [shape[key] for key in wanted] == [0.01, 900.0, 3.0, 0.6, 0.4, 800.0]
    assert [shape[key] for key in ("exponent", "texture_height", "texture_length")] == [1.3, 0.0005, 0.004]
    assert made.materials[shape["material"]] == "wood"


def test_shapes_take_from_their_object_what_they_leave_out(tmp_path):
    shapes = [CUBE, {"shape": "sphere", "radius": 0.05, "stiffness": 300.0, "position": [0.1, 0, 0], "material": "ice"}]
    made = objects(tmp_path, thing("a", haptic_object={"shapes": shapes, "stiffness": 700.0, "friction_dynamic": 0.2}))
    assert made.rows.shapes["stiffness"].tolist() == [700.0, 300.0]
    assert made.rows.shapes["friction_static"].tolist() == [0.2, 0.2]
    assert made.rows.shapes["damping"].tolist() == [5.0, 5.0]
    assert made.materials == ("", "ice")
    assert made.rows.shapes["body"].tolist() == [0, 0]


def test_object_without_shapes_is_as_its_mesh_shows_it(tmp_path):
    def shown(name, **primitive):
        return thing(name, mesh={"primitive": primitive}, haptic_object={})

    made = objects(
        tmp_path,
        shown("box", shape="box", size=[0.1, 0.2, 0.3]),
        shown("ball", shape="sphere", radius=0.05),
        shown("can", shape="cylinder", radius=0.03, height=0.1),
        shown("pill", shape="capsule", radius=0.02, length=0.06),
    )
    kinds = [ShapeKind.BOX, ShapeKind.SPHERE, ShapeKind.CYLINDER, ShapeKind.CAPSULE]
    assert made.rows.shapes["kind"].tolist() == kinds
    assert made.rows.shapes["size"][:, 0].tolist() == [0.1, 0.05, 0.03, 0.02]
    assert made.rows.shapes["size"][2:, 1].tolist() == [0.1, 0.06]


def test_centre_of_mass_of_two_shapes_lies_between_them(tmp_path):
    shapes = [{**CUBE, "position": [0.0, 0, 0]}, {**CUBE, "position": [0.3, 0, 0]}]
    body = objects(tmp_path, thing("a", haptic_object={"shapes": shapes, "density": 500.0})).rows.bodies[0]
    assert body["mass"] == pytest.approx(1.0)
    assert body["centre"] == pytest.approx([0.15, 0, 0])
    own = 0.5 / 6 * 0.01
    assert body["inertia"] == pytest.approx(np.diag([2 * own, 2 * own + 0.15**2, 2 * own + 0.15**2]))


def test_object_that_cannot_move_belongs_to_the_scene(tmp_path):
    fixed = {"shapes": [{**CUBE, "position": [0.1, 0, 0]}], "enable_translation": False, "enable_rotation": False}
    entity = at(1, 0, 0, thing("a", haptic_object=fixed), rotation=TURN)
    made = objects(tmp_path, entity)
    assert len(made.rows.bodies) == 0
    assert made.rows.shapes[0]["body"] == STATIC
    assert made.rows.shapes[0]["position"] == pytest.approx([1.0, 0.1, 0.0])
    assert made.rows.shapes[0]["orientation"] == pytest.approx(TURN)


@pytest.mark.parametrize("wire", [{"from": "a.touched", "to": "pull.force"}, {"from": "time", "to": "a.F_aux"}])
def test_fixed_object_that_a_wire_names_keeps_its_body(tmp_path, wire):
    fixed = {"shapes": [CUBE], "enable_translation": False, "enable_rotation": False}
    pull = thing("pull", haptic_effect={"effect": {"kind": "constant_force", "force": [1, 0, 0]}})
    made = objects(tmp_path, thing("a", haptic_object=fixed), pull, thing("w", connections={"wires": [wire]}))
    assert made.body_entities == ("a",)
    assert made.rows.bodies[0]["flags"] & (BodyFlag.TRANSLATION | BodyFlag.ROTATION) == 0


def test_six_walls_look_inwards_and_keep_their_rows(tmp_path):
    walls = {"size": [2, 4, 6], "stiffness": 1500, "ceiling": {"enabled": False}, "floor": {"damping": 7}}
    made = objects(tmp_path, at(1, 1, 1, thing("room", haptic_walls=walls)))
    rows = made.rows.shapes
    assert rows["kind"].tolist() == [ShapeKind.WALL] * 6
    assert rows["enabled"].tolist() == [1, 1, 1, 0, 1, 1]
    assert rows["damping"].tolist() == [5, 5, 7, 5, 5, 5]
    for row in rows:
        inward = matrix(row["orientation"])[:, 2]
        assert inward @ (np.ones(3) - row["position"]) == pytest.approx(np.abs(row["position"] - 1.0).max())
    assert rows["position"].tolist() == [[0, 1, 1], [2, 1, 1], [1, -1, 1], [1, 3, 1], [1, 1, -2], [1, 1, 4]]


def test_wall_with_its_own_pose_needs_no_room(tmp_path):
    turn = about_axis([1, 0, 0], 0.3).tolist()
    off = {"enabled": False}
    sides = {name: off for name in ("right", "ceiling", "back", "front", "floor")}
    walls = {"left": {"position": [0, 0.1, 0], "rotation": turn}, **sides}
    row = objects(tmp_path, thing("w", haptic_walls=walls)).rows.shapes[0]
    assert row["position"].tolist() == [0, 0.1, 0]
    assert matrix(row["orientation"])[:, 2] == pytest.approx([0, -np.sin(0.3), np.cos(0.3)])


def test_effect_moves_with_its_object(tmp_path):
    """The anchor is kept in the object's frame: here the object is turned by a quarter about z."""
    body = at(1, 0, 0, thing("a", haptic_object={"shapes": [CUBE]}), rotation=TURN)
    spring = {"kind": "spring", "stiffness": 200, "damping": 2, "dead_band": 0.01, "largest_force": 5, "within": 0.2}
    made = objects(
        tmp_path,
        body,
        at(1, 0.2, 0, thing("handle", haptic_effect={"effect": spring, "object": "a"})),
        at(0, 0, 1, thing("tether", haptic_effect={"effect": spring, "object": "a", "acts_on": "object"})),
    )
    row, tether = made.rows.effects
    assert row["position"] == pytest.approx([0.2, 0, 0])
    names = ("kind", "body", "on_body", "stiffness", "damping", "slip", "force", "radius", "enabled")
    assert [row[name] for name in names] == [EffectKind.SPRING, 0, 0, 200, 2, 0.01, 5, 0.2, 1]
    assert (tether["position"].tolist(), tether["on_body"]) == ([0, 0, 1], 1)


def test_effects_arrive_with_their_own_fields(tmp_path):
    path = {"control_points": [[0, 0, 0], [0.1, 0, 0], [0.2, 0.1, 0], [0.3, 0, 0]]}

    def effect(name, **values):
        return thing(name, haptic_effect={"effect": values})

    made = objects(
        tmp_path,
        thing("way", haptic_path=path),
        effect("a", kind="path_spring", path="way", stiffness=300, damping=2),
        effect("b", kind="guidance", path="way", force=2, damping=9),
        effect("c", kind="viscosity", damping=11, within=0.1),
        effect("d", kind="constant_force", force=[0, -3, 4]),
        effect("e", kind="magnet", radius=0.1, force=6, stiffness=500, damping=1),
        effect("f", kind="vibration", direction=[0, 2, 0], amplitude=1.5, frequency=80),
        effect("g", kind="stick_slip", stiffness=400, slip=0.004),
        effect("h", kind="workspace", size=[0.4, 0.3, 0.2], stiffness=800, damping=8, largest_force=30),
        effect("i", kind="workspace", radius=0.2),
        thing("j", force_field={"function": "curl", "parameters": [13], "largest_force": 20}),
        thing("k", force_field={"function": "well", "parameters": [3, 0.1]}),
        thing("l", force_field={"function": "curl"}),
    )
    rows = dict(zip(made.effect_entities, made.rows.effects, strict=True))
    assert len(made.paths) == 1
    assert [rows[name]["path"] for name in "abc"] == [0, 0, -1]
    assert (rows["b"]["force"], rows["b"]["damping"]) == (2, 9)
    assert (rows["c"]["damping"], rows["c"]["radius"]) == (11, 0.1)
    assert rows["d"]["force"] == 5
    assert rows["d"]["direction"] == pytest.approx([0, -0.6, 0.8])
    assert (rows["e"]["radius"], rows["e"]["force"], rows["e"]["stiffness"]) == (0.1, 6, 500)
    assert (rows["f"]["direction"].tolist(), rows["f"]["force"], rows["f"]["frequency"]) == ([0, 1, 0], 1.5, 80)
    assert (rows["g"]["stiffness"], rows["g"]["slip"]) == (400, 0.004)
    assert (rows["h"]["direction"] * 2 == [0.4, 0.3, 0.2]).all()
    assert (rows["h"]["radius"], rows["h"]["force"]) == (0, 30)
    assert rows["i"]["radius"] == 0.2
    assert made.fields == ("curl", "well")
    assert [rows[name]["field"] for name in "jkl"] == [0, 1, 0]
    assert rows["j"]["parameters"][:2].tolist() == [13, 0]


def test_wires_name_rows(tmp_path):
    wires = [
        {"from": "p_rob", "to": "b.F_aux", "gain": 2.0, "offset": [0, 1, 0]},
        {"from": "a.R_obj.y", "to": "b.T_aux", "gain": [[0, 1, 0], [0, 0, 1], [1, 0, 0]]},
        {"from": "grasp", "to": "pull.stiffness"},
    ]
    made = objects(
        tmp_path,
        thing("a", haptic_object={"shapes": [CUBE]}),
        thing("b", haptic_object={"shapes": [CUBE]}),
        thing("pull", haptic_effect={"effect": {"kind": "spring", "stiffness": 10}}),
        thing("w", connections={"wires": wires}),
    )
    rows = made.rows.wires
    assert rows["source"].tolist() == [SignalSource.POSITION_ROBOT, SignalSource.AXIS_Y_OBJECT, SignalSource.GRASP]
    assert rows["source_row"].tolist() == [0, 0, 0]
    assert rows["target"].tolist() == [
        SignalTarget.FORCE_AUX,
        SignalTarget.TORQUE_AUX,
        SignalTarget.EFFECT_STIFFNESS,
    ]
    assert rows["target_row"].tolist() == [1, 1, 0]
    assert rows[0]["gain"].tolist() == (2.0 * np.eye(3)).tolist()
    assert rows[1]["gain"].tolist() == [[0, 1, 0], [0, 0, 1], [1, 0, 0]]


def test_one_point_where_the_scene_says_nothing(tmp_path):
    made = objects(tmp_path, {"id": "empty"})
    assert made.counts[0]["points"] == 1
    assert (made.rows.points["enabled"][0], made.rows.points["radius"][0]) == (1, 0.0)
    assert [made.counts[0][name] for name in ("shapes", "bodies", "effects", "wires")] == [0, 0, 0, 0]


def test_two_fingers(tmp_path):
    points = [{"offset": [0.02, 0, 0], "radius": 0.008}, {"offset": [-0.02, 0, 0], "enabled": False}]
    rows = objects(tmp_path, thing("hand", interaction_points={"points": points})).rows.points
    assert rows["offset"].tolist() == [[0.02, 0, 0], [-0.02, 0, 0]]
    assert rows["radius"].tolist() == [0.008, 0.0]
    assert rows["enabled"].tolist() == [1, 0]


class TestModels:
    """Shapes out of a glTF box of 0.1 x 0.2 x 0.4 m."""

    SIZE = (0.1, 0.2, 0.4)
    ASSETS = {"box": {"uri": "box.gltf"}}  # noqa: RUF012

    def made(self, folder, entity=None, **shape):
        gltf_box(folder, self.SIZE)
        thing_ = {"shapes": [{"shape": "mesh", "source": "box", **shape}], "density": 1000.0}
        return objects(folder, entity or thing("a", haptic_object=thing_), assets=self.ASSETS)

    def test_mass_properties_are_those_of_the_box(self, tmp_path):
        """To float32 of the file."""
        body = self.made(tmp_path).rows.bodies[0]
        assert body["mass"] == pytest.approx(8.0, rel=1e-6)
        assert body["inertia"] == pytest.approx(np.diag([0.2, 0.17, 0.05]) * 8.0 / 12.0, rel=1e-6, abs=1e-9)

    def test_triangles_arrive_once_for_equal_shapes(self, tmp_path):
        gltf_box(tmp_path, self.SIZE)
        shapes = [{"shape": "mesh", "source": "box"}, {"shape": "mesh", "source": "box", "position": [1, 0, 0]}]
        shapes.append({"shape": "mesh", "source": "box", "scale": 0.5})
        made = objects(tmp_path, thing("a", haptic_object={"shapes": shapes}), assets=self.ASSETS)
        assert made.rows.shapes["mesh"].tolist() == [0, 0, 1]
        assert [mesh.triangles.shape for mesh in made.meshes] == [(12, 3), (12, 3)]
        assert made.meshes[1].vertices == pytest.approx(0.5 * made.meshes[0].vertices)
        assert made.meshes[0].watertight

    @pytest.mark.parametrize(("fit", "kind"), [("box", ShapeKind.BOX), ("sphere", ShapeKind.SPHERE)])
    def test_simple_shapes_that_fit_round(self, tmp_path, fit, kind):
        made = self.made(tmp_path, fit=fit)
        assert made.rows.shapes[0]["kind"] == kind
        assert made.meshes == ()
        if fit == "box":
            assert made.rows.shapes[0]["size"] == pytest.approx(self.SIZE)

    def test_node_of_a_model_brings_its_own_place(self, tmp_path):
        """Components on a node of a model (as written in a modeller): its pose is the node's."""
        path = gltf_box(tmp_path, self.SIZE)
        text = path.read_text()
        node = '{"name": "Box", "mesh": 0}'
        extras = (
            '"extras": {"mimics": {"components": {"haptic_object": {"shapes": [{"shape": "sphere", "radius": 0.05}]}}}}'
        )
        assert node in text
        path.write_text(text.replace(node, node[:-1] + f', "translation": [0, 1, 0], {extras}}}'))
        entity = at(2, 0, 0, thing("table", mesh={"source": "box"}))
        scene = loaded(tmp_path, entity, assets=self.ASSETS)
        made = objects_of_scene(scene)
        assert made.body_entities == ("table/Box",)
        assert made.rows.bodies[0]["position"].tolist() == [2, 1, 0]


def test_a_box_has_one_name_for_eye_and_hand_and_its_older_name_is_read() -> None:
    """What a mesh calls a box, a shape to touch calls a box; recordings of before say cube."""
    told = {"size": [0.1, 0.2, 0.3], "rounding": 0.01, "position": [0.0, 0.1, 0.0]}
    box, cube = (msgspec.convert({"shape": name, **told}, Solid) for name in ("box", "cube"))
    assert isinstance(box, BoxSolid) and isinstance(cube, BoxSolid)
    assert msgspec.structs.asdict(box) == msgspec.structs.asdict(cube)
