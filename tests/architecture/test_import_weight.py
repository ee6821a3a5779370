"""Light imports, seen in a fresh process: help is quick, and a part that is not used is not imported."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from mimics_app.app.cli import COMMANDS
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


def _modules_after(code: str) -> set[str]:
    script = f"import sys, json\n{code}\nsys.stderr.write('\\n' + json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(json.loads(done.stderr.splitlines()[-1]))


def test_the_probe_sees_an_import() -> None:
    """The test below can fail."""
    assert HEAVY & _modules_after("import numpy") == {"numpy"}


def test_help_imports_nothing_heavy_and_no_command() -> None:
    loaded = _modules_after("from mimics_app.app.cli import main; main(['--help'])")
    assert not loaded & HEAVY
    assert not [name for name in loaded if name.startswith("mimics_app.app.commands")]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_one_command_imports_nothing_heavy(command: str) -> None:
    loaded = _modules_after(f"from mimics_app.app.cli import main; main(['{command}', '--help'])")
    assert f"mimics_app.app.commands.{command}" in loaded
    assert not loaded & HEAVY


def test_errors_and_resources_import_nothing_heavy() -> None:
    code = "import mimics_app, mimics_app.contracts.errors, mimics_app.contracts.resources, mimics_app.contracts.clock"
    assert not _modules_after(code) & HEAVY


def test_the_table_of_commands_is_the_folder() -> None:
    files = {file.stem for file in (PACKAGE / "app" / "commands").glob("*.py")} - {"__init__"}
    assert files == {*COMMANDS, "launch"}


def test_a_run_needs_no_template_engine_before_its_report() -> None:
    """What plays a session, and the module of the report itself, are there before the page is made."""
    code = "import mimics_app.app.play.play, mimics_app.recording.report"
    assert not _modules_after(code) & {"jinja2"}
