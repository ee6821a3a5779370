"""Light imports, seen in a fresh process: help is quick, and a part that is not used is not imported."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from mimics_app.app.cli import COMMANDS
from mimics_app.compiled.kernel import kernel
from tests.architecture.sources import PACKAGE, ROOT

HEAVY = {
    "PIL",
    "glfw",
    "importlib.metadata",
    "jinja2",
    "llvmlite",
    "moderngl",
    "msgspec",
    "multiprocessing",
    "numba",
    "numpy",
    "openal",
    "pyarrow",
    "pyrr",
    "scipy",
    "serial",
    "trimesh",
}


def _said(code: str) -> list[str]:
    """Lines that a fresh process writes to stderr."""
    command = [sys.executable, "-c", f"import sys, json\n{code}"]
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stderr.splitlines()


def _modules_after(code: str) -> set[str]:
    return set(json.loads(_said(f"{code}\nsys.stderr.write('\\n' + json.dumps(sorted(sys.modules)))")[-1]))


def test_the_probe_sees_an_import() -> None:
    """The test below can fail."""
    assert HEAVY & _modules_after("import numpy") == {"numpy"}


def test_help_imports_nothing_heavy_and_no_command() -> None:
    loaded = _modules_after("from mimics_app.app.cli import main; main(['--help'])")
    assert not loaded & HEAVY
    assert not [name for name in loaded if name.startswith("mimics_app.app.commands")]


_HELP_OF_EACH = """
from mimics_app.app.cli import COMMANDS, main
for command in COMMANDS:
    before = set(sys.modules)
    main([command, '--help'])
    sys.stderr.write(json.dumps([command, sorted(set(sys.modules) - before)]) + '\\n')
"""


@pytest.fixture(scope="module")
def loaded_by_help() -> dict[str, set[str]]:
    """What the help of one command after the other imports beyond those before it."""
    rows = [json.loads(line) for line in _said(_HELP_OF_EACH)]
    return {command: set(loaded) for command, loaded in rows}


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_one_command_imports_nothing_heavy(loaded_by_help: dict[str, set[str]], command: str) -> None:
    loaded = loaded_by_help[command]
    assert f"mimics_app.app.commands.{command}" in loaded
    assert not loaded & HEAVY


def test_errors_and_resources_import_nothing_heavy() -> None:
    code = "import mimics_app.contracts.errors, mimics_app.contracts.system.resources, mimics_app.contracts.clock"
    assert not _modules_after(code) & HEAVY


def test_the_table_of_commands_is_the_folder() -> None:
    files = {file.stem for file in (PACKAGE / "app" / "commands").glob("*.py")} - {"__init__"}
    assert files == {*COMMANDS, "launch"}


def test_the_recorder_process_reaches_no_compiler() -> None:
    """Else it takes twice as long to come up, and as much memory again."""
    assert not _modules_after("import mimics_app.recording.recorder_process") & {"numba", "llvmlite", "scipy"}


def test_linear_algebra_can_still_be_called_by_compiled_functions() -> None:
    def product(a, b):
        return np.dot(a, b)

    assert list(kernel(product)(2.0 * np.eye(3), np.arange(3.0))) == [0.0, 2.0, 4.0]


def test_a_run_needs_no_template_engine_before_its_report_and_no_renderer_before_its_picture() -> None:
    """What plays a session, and the module of the report itself, are there before the page is made."""
    code = "import mimics_app.app.play.play, mimics_app.app.session.requested, mimics_app.recording.report"
    late = {"jinja2", "moderngl", "mimics_app.rendering.visual.renderer", "mimics_app.rendering.visual.displays"}
    assert not _modules_after(code) & late
