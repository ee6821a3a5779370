"""A part that a scene does not need is neither imported nor run: seen in a fresh process that plays a whole session."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.architecture.sources import ROOT

SCENE = ROOT / "scenes" / "wavy_tunnel.json"

SOUND = ("mimics_app.rendering.audio", "mimics_app.rendering.audio.openal_library")
PICTURE = ("moderngl", "glfw", "pyrr")
BODIES = (
    "mimics_app.rendering.haptic.kernels.friction",
    "mimics_app.rendering.haptic.kernels.rotation",
    "mimics_app.rendering.haptic.kernels.contact",
)
LABORATORY = ("mimics_app.lab",)

SESSION = """
import json, sys
from pathlib import Path
from mimics_app.app.session.assembly import build_session
from mimics_app.app.session.frame import Frames
from mimics_app.app.play.pace import run_virtual
from mimics_app.app.settings import RunSettings
settings = RunSettings(Path(sys.argv[1]), headless=True, seconds=0.5, runs=Path(sys.argv[2]), pictures=0)
with build_session(settings, live=False) as session:
    run_virtual(session, Frames(session), lambda frames: None)
    sound = type(session.sound).__name__ != "NullSound"
    session.end_stages()
    session.finish({})
print(json.dumps({"sound": sound, "plan": session.scene.methods, "modules": sorted(sys.modules)}))
"""


def play(scene: Path, runs: Path) -> dict[str, Any]:
    command = [sys.executable, "-c", SESSION, str(scene), str(runs)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def loaded(answer: dict[str, Any], names: tuple[str, ...]) -> set[str]:
    return {name for name in names if any(one == name or one.startswith(f"{name}.") for one in answer["modules"])}


@pytest.fixture(scope="module")
def silent(tmp_path_factory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("silent")
    document = json.loads(SCENE.read_text())
    for entity in document["entities"]:
        for name in ("sound", "sound_emitter"):
            entity["components"].pop(name, None)
    document["include"], document["assets"] = [], {}
    document["entities"] = [entity for entity in document["entities"] if "encourager" not in entity["components"]]
    for name in ("frontal_workspace", "frontal_bench"):
        part = json.loads((ROOT / "scenes" / "parts" / f"{name}.json").read_text())
        kept = [one for one in part["entities"] if not {"sound", "sound_emitter"} & set(one.get("components", {}))]
        document["entities"] += kept
        for section in ("assets", "materials", "prefabs"):
            document[section] = {**part.get(section, {}), **document.get(section, {})}
    file = folder / "silent.json"
    file.write_text(json.dumps({key: value for key, value in document.items() if value not in ({}, [])}))
    return play(file, folder)


def test_a_scene_without_sound_bodies_or_skins_imports_none_of_that(silent):
    assert not silent["sound"]
    assert loaded(silent, SOUND) == set()
    assert loaded(silent, BODIES) == set()
    assert "spatialiser" not in silent["plan"]
    assert not [name for name in silent["modules"] if "skin" in name and name.startswith("mimics_app")]


def test_a_session_that_draws_nothing_imports_nothing_of_the_picture(silent):
    assert loaded(silent, PICTURE) == set()


def test_a_plan_measures_nothing(silent):
    assert loaded(silent, LABORATORY) == set()
    assert not [name for name in silent["modules"] if ".methods_" in name]


def test_the_probe_sees_sound_where_there_is_some(tmp_path):
    """The tests above can fail."""
    heard = play(SCENE, tmp_path)
    assert heard["sound"]
    assert loaded(heard, SOUND) == set(SOUND)
    assert heard["plan"]["spatialiser"] == {"hrtf": True, "mixer": "openal"}


PICTURE_OF = """
import json, sys
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.world.components.effects import Billboard
from mimics_app.world.content.world import World
world = World()
node = world.root.create_child("eye")
node.create_camera()
if sys.argv[1] == "billboard":
    world.effects.add(node.index, Billboard())
world.update()
with create_surface("egl", (16, 16)) as surface:
    Renderer(surface, world).draw(desktop_views(world.cameras[0], (16, 16)))
print(json.dumps([name for name in sys.modules if name == "mimics_app.rendering.visual.stages.effect_stage"]))
"""


@pytest.mark.parametrize(("what", "modules"), [("nothing", 0), ("billboard", 1)])
def test_a_picture_without_effects_loads_none_of_that(what, modules):
    command = [sys.executable, "-c", PICTURE_OF, what]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr
    assert len(json.loads(done.stdout.splitlines()[-1])) == modules
