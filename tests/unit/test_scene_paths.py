"""Where a scene's files may lie, and what reading a scene must not drag in."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.contracts.system import resources
from mimics_app.world.files.reading.paths import PathFault, find_file, find_root
from tests.support.scenes import faults, scene, write

ROOT = Path(__file__).parents[2]


def test_the_root_is_the_nearest_folder_with_scenes_and_assets_else_the_scenes_own(tmp_path):
    for name in ("lab/scenes/examples", "lab/assets", "alone"):
        (tmp_path / name).mkdir(parents=True)
    assert find_root(tmp_path / "lab" / "scenes" / "examples" / "a.json") == tmp_path / "lab"
    assert find_root(tmp_path / "lab" / "scenes" / "a.json") == tmp_path / "lab"
    assert find_root(tmp_path / "alone" / "a.json") == tmp_path / "alone"


def test_a_scene_reaches_assets_beside_its_folder_and_nothing_further_up(tmp_path):
    lab = tmp_path / "lab"
    for folder in (lab / "scenes", lab / "assets"):
        folder.mkdir(parents=True)
    for place in (lab / "assets" / "p.csv", tmp_path / "p.csv"):
        place.write_text("x,y,z\n")
    assert faults(write(lab / "scenes", scene(assets={"p": {"uri": "../assets/p.csv"}}))) == []
    assert (
        "leads out of the folder lab" in faults(write(lab / "scenes", scene(assets={"p": {"uri": "../../p.csv"}})))[0]
    )


def test_files_of_the_installation_are_reached_from_anywhere_and_only_they(tmp_path):
    found = find_file("mimics:scenes/wavy_tunnel.json", tmp_path, tmp_path)
    assert found == (resources.root() / "scenes" / "wavy_tunnel.json").resolve()
    with pytest.raises(PathFault, match="leads out"):
        find_file("mimics:../../etc/passwd", tmp_path, tmp_path)


def test_percent_encoding_is_undone_once(tmp_path):
    (tmp_path / "a b.csv").write_text("x")
    (tmp_path / "a%20b.csv").write_text("y")
    assert find_file("a%20b.csv", tmp_path, tmp_path).read_text() == "x"
    assert find_file("a%2520b.csv", tmp_path, tmp_path).read_text() == "y"


def test_reading_a_scene_without_models_imports_no_compiler_window_or_picture_library():
    program = (
        "import sys\n"
        "from pathlib import Path\n"
        "from mimics_app.world.files.scene.file import load_scene\n"
        "load_scene(Path('scenes/examples/path_tunnel.json'))\n"
        "print([name for name in ('numba', 'moderngl', 'glfw', 'PIL', 'trimesh', 'openal') if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.strip() == "[]"
