"""The scenes and the script that show effects, as they looked when somebody last looked at them."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image

from mimics_app.app.play.stills import draw_stills
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.system.resources import root
from mimics_app.world.content.world import World

SIZE = (320, 180)
SCENES = root() / "scenes" / "examples"
SCRIPT = Path(__file__).parents[2] / "examples" / "procedural_mesh" / "waving_flag.py"


def draw(name: str, folder: Path, backend: str, *, frames: int = 1, seed: int = 1) -> tuple[np.ndarray, str]:
    """The last frame of 1.2 s, and what drew it."""
    settings = RunSettings(SCENES / f"{name}.json", seed=seed, size=SIZE)
    try:
        stills = draw_stills(settings, folder, backend=backend, frames=frames, seconds=1.2)
    except DeviceError as error:
        pytest.skip(str(error))
    with Image.open(stills.files[-1]) as picture:
        return np.array(picture.convert("RGB")), stills.gl


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
@pytest.mark.parametrize("name", ["billboards_and_particles", "decals", "lokomat_free_swing"])
def test_a_scene_looks_as_it_did(name, backend, tmp_path, assert_golden):
    picture, driver = draw(name, tmp_path, backend)
    # A rounding apart moves single pixels of a spark or a leaf's edge on another driver.
    assert_golden(picture, name, *((1, 0.999) if "llvmpipe" in driver else (12, 0.97)))


def test_particles_are_where_they_are_whatever_frames_came_before(tmp_path):
    once, _ = draw("billboards_and_particles", tmp_path / "once", "egl")
    often, _ = draw("billboards_and_particles", tmp_path / "often", "egl", frames=5)
    other, _ = draw("billboards_and_particles", tmp_path / "other", "egl", seed=2)
    assert (once == often).all()
    assert (once != other).any()


def load_script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("waving_flag", SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_computed_mesh_moves_as_its_formula_says(tmp_path, assert_golden):
    script = load_script()
    pictures = []
    for file in script.draw(tmp_path, 3, SIZE):
        with Image.open(file) as picture:
            pictures.append(np.array(picture.convert("RGB")))
    assert (pictures[0] != pictures[2]).any(axis=-1).mean() > 0.005
    world = World()
    world.set_mesh("flag", script.make_flag())
    lines = script.declare(world.open_mesh("flag"))
    assert lines[0] == "in_position: 3 x f4 at byte 0 of 32" and len(lines) == 4
    assert_golden(pictures[-1], "waving_flag", 2, 0.995)
