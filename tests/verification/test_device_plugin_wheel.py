"""The example of a third party's device: built as its own wheel, installed beside the product, through the same kit."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "device_plugin"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel in it, for the module path: no registry is asked."""
    folder = tmp_path_factory.mktemp("plugin")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder / "wheel")]
    subprocess.run(command, cwd=EXAMPLE, check=True, capture_output=True)
    with ZipFile(next((folder / "wheel").glob("*.whl"))) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def _mimics(installed: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": f"{installed}{os.pathsep}{ROOT}"}
    command = [sys.executable, "-m", "mimics_app", *arguments]
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)


def test_it_has_at_most_80_lines() -> None:
    assert len((EXAMPLE / "mass_on_rails.py").read_text(encoding="utf-8").splitlines()) <= 80


def test_it_passes_the_kit_under_its_name(installed: Path) -> None:
    done = _mimics(installed, "devices", "check", "mass_on_rails", "--json")
    assert done.returncode == 0, done.stderr
    verdicts = [one["verdict"] for one in json.loads(done.stdout)["checks"]]
    assert verdicts.count("passed") >= 24 and "failed" not in verdicts


def test_its_guide_runs(installed: Path) -> None:
    snippet = re.findall(r"```python\n(.*?)```", (EXAMPLE / "README.md").read_text(encoding="utf-8"), re.DOTALL)[0]
    environment = os.environ | {"PYTHONPATH": f"{installed}{os.pathsep}{ROOT}"}
    done = subprocess.run([sys.executable, "-c", snippet], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_without_the_wheel_its_name_is_unknown(tmp_path: Path) -> None:
    done = _mimics(tmp_path, "devices", "check", "mass_on_rails")
    assert done.returncode == 4 and 'no device "mass_on_rails"' in done.stderr
