"""What is computed of a scene is computed once a load, and handed on; also where the file is saved again."""

from __future__ import annotations

import gc
import json
import shutil
import weakref
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from mimics_app.app.play.reload import SceneReload
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.core import SessionCore, open_core
from mimics_app.app.session.preparation import prepare, prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic import scene_object, scene_objects, scene_tunnel
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.rendering.haptic.scene_tunnel import tunnel_rows
from mimics_app.world.files.scene import model_shelf
from mimics_app.world.files.scene.model_shelf import ModelShelf, digest_of
from tests.support.core_play import change_component
from tests.support.object_scenes import at, gltf_box, thing, written

SCENES = root() / "scenes"


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """What was computed, in order."""
    names: list[str] = []

    def counted(module: Any, name: str) -> None:
        real = getattr(module, name)

        def count(*arguments: Any, **options: Any) -> Any:
            names.append(name)
            return real(*arguments, **options)

        monkeypatch.setattr(module, name, count)

    counted(scene_tunnel, "tunnel_from_component")
    counted(scene_objects, "_gather")
    counted(scene_objects, "build_mesh_table")
    yield names


def test_a_start_works_out_the_tunnel_the_objects_and_their_meshes_once(made: list[str]) -> None:
    parts = prepare(RunSettings(SCENES / "wavy_tunnel.json"), live=False)
    parts.plugin.close()
    assert sorted(made) == ["_gather", "build_mesh_table", "tunnel_from_component"]


def test_a_model_is_decoded_once_while_somebody_has_it_and_its_file_is_as_it_was(tmp_path: Path) -> None:
    models, shelf = root() / "assets" / "models", ModelShelf()
    file = tmp_path / "model.glb"
    shutil.copy(models / "touch" / "stone.glb", file)
    stone, digest = shelf.read(file, tmp_path)
    assert shelf.read(file, tmp_path) == (stone, digest) and digest == digest_of([file])
    shutil.copy(models / "market" / "jug.glb", file)
    jug, other = shelf.read(file, tmp_path)
    assert [mesh.name for mesh in jug.meshes] != [mesh.name for mesh in stone.meshes] and other == digest_of([file])
    gone = weakref.ref(jug)
    del jug
    gc.collect()
    assert gone() is None and shelf.read(file, tmp_path)[1] == other
    shelf.keep()
    kept = id(shelf.read(file, tmp_path)[0])
    gc.collect()
    assert id(shelf.read(file, tmp_path)[0]) == kept
    file.unlink()
    with pytest.raises(SceneError, match="no such file"):
        shelf.read(file, tmp_path)


def test_a_model_that_was_saved_while_it_was_read_is_decoded_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The digest would be that of the new bytes, under which nobody would ever see the new model."""
    models, shelf = root() / "assets" / "models", ModelShelf()
    file, real = tmp_path / "model.glb", model_shelf.load_gltf
    shutil.copy(models / "touch" / "stone.glb", file)

    def saved_meanwhile(*arguments: Any) -> Any:
        model = real(*arguments)
        shutil.copy(models / "market" / "jug.glb", file)
        return model

    monkeypatch.setattr(model_shelf, "load_gltf", saved_meanwhile)
    stone, _ = shelf.read(file, tmp_path)
    monkeypatch.undo()
    jug, _ = shelf.read(file, tmp_path)
    assert [mesh.name for mesh in jug.meshes] != [mesh.name for mesh in stone.meshes]
    assert shelf.read(file, tmp_path)[0] is jug


def in_parts(model: Path, folder: Path) -> Path:
    """Write a GLB as a .gltf file with its buffer, and a picture of its first material, beside it."""
    data = model.read_bytes()
    end = 20 + int.from_bytes(data[12:16], "little")
    document = json.loads(data[20:end])
    (folder / "model.bin").write_bytes(data[end + 8 :])
    Image.new("RGB", (2, 2), (90, 60, 30)).save(folder / "model.png")
    document["buffers"][0]["uri"] = "model.bin"
    document |= {"images": [{"uri": "model.png"}], "textures": [{"source": 0}]}
    document["materials"][0].setdefault("pbrMetallicRoughness", {})["baseColorTexture"] = {"index": 0}
    (folder / "model.gltf").write_text(json.dumps(document))
    return folder / "model.gltf"


@pytest.mark.parametrize("beside", ["model.bin", "model.png"])
def test_a_file_beside_a_model_that_was_saved_while_it_was_read_is_read_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, beside: str
) -> None:
    """Of a model in several files each is decoded, and each is in the digest."""
    shelf, real = ModelShelf(), model_shelf.load_gltf
    file = in_parts(root() / "assets" / "models" / "touch" / "stone.glb", tmp_path)

    def saved_meanwhile(*arguments: Any) -> Any:
        model = real(*arguments)
        (tmp_path / beside).write_bytes((tmp_path / beside).read_bytes() + b"more")  # as much as is needed is read
        return model

    monkeypatch.setattr(model_shelf, "load_gltf", saved_meanwhile)
    first, _ = shelf.read(file, tmp_path)
    monkeypatch.undo()
    second, _ = shelf.read(file, tmp_path)
    assert second is not first and shelf.read(file, tmp_path)[0] is second


def test_a_component_that_a_test_changes_takes_effect_where_it_was_derived_already(made: list[str]) -> None:
    scene = load_checked_scene(SCENES / "wavy_tunnel.json")
    wide = float(tunnel_rows(scene)[0]["radius"][0, 0, 0])
    change_component(scene, "tunnel", radius=0.5 * wide)
    parts = prepare_scene(scene, RunSettings(scene.path))
    parts.plugin.close()
    assert objects_of_scene(parts.scene).rows.tunnels["radius"][0, 0, 0] == 0.5 * wide
    made.clear()
    change_component(scene, "patient", preset="severe")
    tunnel_rows(scene)
    assert made == []


def test_the_table_of_meshes_is_made_once(made: list[str]) -> None:
    parts = prepare(RunSettings(SCENES / "examples" / "models.json"), live=False)
    parts.plugin.close()
    assert len(objects_of_scene(parts.scene).meshes) == 2
    assert made == ["_gather", "build_mesh_table"]


def test_a_reload_of_the_same_scene_works_nothing_out_but_the_tables_rows_are_put_together_in(
    made: list[str], tmp_path: Path
) -> None:
    scene = load_checked_scene(file := copy_tunnel(tmp_path))
    with open_core(prepare_scene(scene, RunSettings(file))) as core:
        session: Any = core
        session.settings, session.picture = RunSettings(file), None
        reload = SceneReload(session)
        made.clear()
        file.write_text(file.read_text() + "\n")
        look_later(reload, core)
        assert core.scene is not scene, reload.message
    assert made == ["_gather"]


def test_every_fault_of_a_reloaded_scene_is_on_the_terminal_and_changes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The picture has room for one of them."""
    scene = load_checked_scene(file := copy_tunnel(tmp_path))
    with open_core(prepare_scene(scene, RunSettings(file))) as core:
        session: Any = core
        session.settings, session.picture = RunSettings(file), None
        reload = SceneReload(session)
        file.write_text(file.read_text().replace('"up"', '"upp": 1, "down"'))
        look_later(reload, core)
        assert core.scene is scene and "/upp" in reload.message
    said = capsys.readouterr().err
    assert "/upp" in said and "/down" in said and said.count("\n") == 2


def test_a_hard_object_that_moved_is_said_to_be_felt_at_its_place_from_the_next_start(tmp_path: Path) -> None:
    """A running loop keeps its controller with its parameters, and the picture has the object where it is now."""
    file = copy_tunnel(tmp_path).parent / "examples" / "lokomat_wall.json"
    document = json.loads(file.read_text())
    robot = next(each for each in document["entities"] if each["id"] == "robot")
    robot["components"]["controller"] = {"name": "lokomat_combined", "hard_object": "stone"}
    stone = thing("stone", mesh={"primitive": {"shape": "box", "size": [0.3, 0.6, 0.5]}})
    document["entities"].append(at(0.5, 0.3, 0.0, stone))
    file.write_text(json.dumps(document))
    scene = load_checked_scene(file)
    with open_core(prepare_scene(scene, RunSettings(file))) as core:
        session: Any = core
        session.settings, session.picture = RunSettings(file), None
        reload = SceneReload(session)
        document["entities"][-1]["transform"]["translation"] = [0.6, 0.3, 0.0]
        file.write_text(json.dumps(document))
        look_later(reload, core)
        assert core.scene is not scene
        assert reload.message == "scene reloaded; controller at the next start"


def copy_tunnel(folder: Path) -> Path:
    """A copy of the wavy tunnel, which a test may edit."""
    shutil.copytree(SCENES, folder / "scenes", ignore=shutil.ignore_patterns("*.png"))
    (folder / "assets").symlink_to(root() / "assets")
    return folder / "scenes" / "wavy_tunnel.json"


def look_later(reload: SceneReload, core: SessionCore) -> None:
    """A look now, and one when the watcher has seen that the file rests."""
    for second in range(1, 4):
        core.clock.sleep_until_ns(second * 1_000_000_000)
        reload.check(between=True)


def many_things(folder: Path) -> Path:
    """A scene of forty boxes, two bodies of one model, walls and a tunnel."""
    boxes = [
        at(0.1 * i, 0.0, 0.0, thing(f"box_{i}", haptic_object={
            "shapes": [{"shape": "cube", "size": [0.02, 0.03, 0.04]}], "stiffness": 500.0 + i, "damping": 5.0,
            "mass": 2.0, "enable_translation": i % 2 == 0, "material": f"m{i % 3}",
        }))
        for i in range(40)
    ]  # fmt: skip
    shapes = [{"shape": "mesh", "source": "model", "fit": "hull"}]
    bodies = [
        at(0.0, 0.2 * i, 1.0, thing(f"model_{i}", haptic_object={
            "shapes": shapes, "stiffness": 400.0, "damping": 4.0, "mass": 1.0, "enable_translation": True,
        }))
        for i in range(2)
    ]  # fmt: skip
    tube = {"control_points": [[0.02 * i - 0.1, 0.0, 0.0] for i in range(9)], "radius": 0.02}
    rest = [thing("room", haptic_walls={"size": [4.0, 4.0, 4.0]}), thing("tube", tunnel=tube)]
    model = gltf_box(folder, (0.05, 0.05, 0.05)).name
    return written(folder, *boxes, *bodies, *rest, assets={"model": {"uri": model}})


def bits(tables: Iterable[Any]) -> list[dict[str, bytes]]:
    """Every bit of tables that says something; between fields lies what nobody wrote."""
    fields: Any = [{name: table[name] for name in table.dtype.names or ()} or {"": table} for table in tables]
    return [{name: np.ascontiguousarray(column).tobytes() for name, column in each.items()} for each in fields]


def test_one_changed_stiffness_makes_its_own_object_anew_and_no_other(
    made: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file = many_things(tmp_path)
    real = scene_object._make_object
    monkeypatch.setattr(scene_object, "_make_object", lambda scene, entity, *rest: (
        made.append(entity), real(scene, entity, *rest))[1])  # fmt: skip
    first = load_checked_scene(file)
    assert len([name for name in made if name.startswith(("box_", "model_"))]) == 42
    made.clear()
    document = json.loads(file.read_text())
    document["entities"][17]["components"]["haptic_object"]["stiffness"] = 640.0
    document["entities"].insert(0, document["entities"].pop(30))  # and another stands elsewhere in the file
    file.write_text(json.dumps(document))
    second = load_checked_scene(file, before=first)
    assert made == ["_gather", "box_17"]
    third = load_checked_scene(file)
    one, other = objects_of_scene(second), objects_of_scene(third)
    assert bits(one.rows) == bits(other.rows) and bits(one.mesh_table) == bits(other.mesh_table)
    assert (one.body_entities, one.shape_entities, one.materials) == (
        other.body_entities, other.shape_entities, other.materials
    )  # fmt: skip
    assert one.mesh_table is objects_of_scene(first).mesh_table
    assert one.rows.shapes[one.shape_entities.index("box_17")]["stiffness"] == 640.0


@pytest.mark.parametrize("change", ["place", "parent", "mesh", "planned"])
def test_whatever_an_object_goes_by_makes_it_anew(tmp_path: Path, change: str) -> None:
    """What is taken over is what a full load would make."""
    file = written(
        tmp_path,
        thing("frame"),
        {"parent": "frame", **thing(
            "box", mesh={"primitive": {"shape": "box", "size": [0.1, 0.1, 0.1]}, "material": "grey"},
            haptic_object={"stiffness": 300.0, "damping": 3.0, "mass": 1.0, "enable_translation": True},
        )},
        materials={"grey": {}},
    )  # fmt: skip
    first = load_checked_scene(file)
    document = json.loads(file.read_text())
    frame, box = document["entities"][:2]
    if change == "place":
        box["transform"] = {"translation": [0.0, 0.1, 0.0]}
    elif change == "parent":
        frame["transform"] = {"rotation": [0.0, 0.6, 0.0, 0.8]}
    elif change == "mesh":
        box["components"]["mesh"]["primitive"]["size"] = [0.2, 0.1, 0.1]
    file.write_text(json.dumps(document))
    second, third = load_checked_scene(file, before=first), load_checked_scene(file)
    for scene in (second, third):
        scene.methods = {"colliding bodies": {"integrator": "explicit"}} if change == "planned" else {}
    one, other = objects_of_scene(second), objects_of_scene(third)
    assert bits(one.rows) == bits(other.rows)
    assert bits(one.rows) != bits(objects_of_scene(first).rows)


def test_sessions_of_one_scene_share_no_row_that_can_be_changed() -> None:
    scene = load_checked_scene(SCENES / "pick_and_place.json")
    first, second = (prepare_scene(scene, RunSettings(scene.path)) for _ in range(2))
    for parts in (first, second):
        parts.plugin.close()
    before = second.parameter_store.value("bodies.apple.mass")
    first.parameter_store.change({"bodies.apple.mass": before + 1.0})
    assert second.parameter_store.value("bodies.apple.mass") == before
    assert objects_of_scene(scene).rows.bodies[0]["mass"] == before


def test_what_is_handed_on_counts_as_read() -> None:
    scene = load_checked_scene(SCENES / "pick_and_place.json")
    assert "haptic_object" in scene.unread
    objects_of_scene(scene)
    assert "haptic_object" not in scene.unread
