"""The figure stays true: import-linter is green here, and red on each planted violation."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.sources import PACKAGE, ROOT

PLANTED = {
    "one stage imports another": (
        "dsp/planted.py",
        "from mimics_app.learning import planted_target\n",
        "Imports only go down",
    ),
    "a lower layer imports a higher one": ("maths/planted.py", "import mimics_app.world\n", "Imports only go down"),
    "touch imports picture": (
        "rendering/haptic/planted.py",
        "import mimics_app.rendering.visual\n",
        "Touch, picture and sound",
    ),
    "OpenGL in a kernel": ("rendering/haptic/kernels/planted.py", "import moderngl\n", "Kernels know only arrays"),
    "OpenGL inside a function of the world": (
        "world/planted.py",
        "def draw():\n    import moderngl\n    return moderngl\n",
        "OpenGL and windows",
    ),
    "a kernel that reaches JSON through maths": (
        "maths/planted_json.py",
        "import json\n",
        "Kernels know only arrays",
    ),
    "a room of the application knows the one above it": (
        "app/picture/planted.py",
        "import mimics_app.app.session.session\n",
        "Rooms of the application",
    ),
    "a device knows the loop that plays it": (
        "rendering/haptic/devices/planted.py",
        "import mimics_app.rendering.haptic.loop\n",
        "Rooms of touch",
    ),
    "a law knows the tick that uses it": (
        "rendering/haptic/kernels/friction.py",
        "import mimics_app.rendering.haptic.kernels.tick\n",
        "Kernels of touch",
    ),
    "a pass knows the stage that prepares it": (
        "rendering/visual/passes/planted.py",
        "import mimics_app.rendering.visual.stages.world_stage\n",
        "Rooms of the picture",
    ),
    "a table of the world knows scenes": (
        "world/store.py",
        "import mimics_app.world.scene.scene\n",
        "Rooms of the world",
    ),
    "a probe knows the chart it is drawn in": (
        "lab/haptic/planted.py",
        "import mimics_app.lab.chart\n",
        "Rooms of the laboratory",
    ),
    "a new module of touch nobody planned": ("rendering/haptic/planted.py", "", "Rooms of touch"),
    "a new room nobody planned": ("attic/__init__.py", "", "Imports only go down"),
}


def _lint(folder: Path) -> subprocess.CompletedProcess[str]:
    tool = Path(sys.executable).with_name("lint-imports")
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    command = [str(tool), "--no-cache"]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """A copy of the package that may be spoilt."""
    shutil.copytree(PACKAGE, tmp_path / "mimics_app", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_the_layers_are_kept() -> None:
    done = _lint(ROOT)
    assert done.returncode == 0, done.stdout


def test_the_copy_is_what_is_linted(copied: Path) -> None:
    """Without this, planted faults might be looked for in the installed package."""
    assert _lint(copied).returncode == 0


@pytest.mark.parametrize("what", PLANTED)
def test_planted_violation_is_caught(copied: Path, what: str) -> None:
    place, code, contract = PLANTED[what]
    file = copied / "mimics_app" / place
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(code)
    (copied / "mimics_app" / "learning" / "planted_target.py").write_text("")
    if place == "maths/planted_json.py":
        kernel = copied / "mimics_app" / "rendering" / "haptic" / "kernels" / "planted.py"
        kernel.write_text("import mimics_app.maths.planted_json\n")
    done = _lint(copied)
    assert done.returncode == 1, done.stdout
    broken = [line for line in done.stdout.splitlines() if line.endswith("BROKEN")]
    assert any(line.startswith(contract) for line in broken), done.stdout
