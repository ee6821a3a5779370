"""What is worked out of a scene is worked out once a load, and handed on; also where the file is saved again."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mimics_app.app.play.reload import SceneReload
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.core import SessionCore, open_core
from mimics_app.app.session.preparation import prepare, prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.resources import root
from mimics_app.rendering.haptic import scene_objects, scene_tunnel
from mimics_app.rendering.haptic.scene_objects import objects_of_scene

SCENES = root() / "scenes"


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """What was worked out, in order."""
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


def test_the_table_of_meshes_is_made_once(made: list[str]) -> None:
    parts = prepare(RunSettings(SCENES / "examples" / "models.json"), live=False)
    parts.plugin.close()
    assert len(objects_of_scene(parts.scene).meshes) == 2
    assert made == ["_gather", "build_mesh_table"]


def test_a_reload_works_everything_out_once_more_and_no_oftener(made: list[str], tmp_path: Path) -> None:
    shutil.copytree(SCENES, tmp_path / "scenes", ignore=shutil.ignore_patterns("*.png"))
    (tmp_path / "assets").symlink_to(root() / "assets")
    file = tmp_path / "scenes" / "wavy_tunnel.json"
    scene = load_checked_scene(file)
    with open_core(prepare_scene(scene, RunSettings(file))) as core:
        session: Any = core
        session.settings, session.picture = RunSettings(file), None
        reload = SceneReload(session)
        made.clear()
        file.write_text(file.read_text() + "\n")
        look_later(reload, core)
        assert core.scene is not scene, reload.message
    assert sorted(made) == ["_gather", "build_mesh_table", "tunnel_from_component"]


def look_later(reload: SceneReload, core: SessionCore) -> None:
    """A look now, and one when the watcher has seen that the file rests."""
    for second in range(1, 4):
        core.clock.sleep_until_ns(second * 1_000_000_000)
        reload.look()


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
