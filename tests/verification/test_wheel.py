"""The wheel carries its data and works from outside the repository, in an environment that never saw it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path
from zipfile import ZipFile

import pytest

from mimics_app.contracts.resources import FOLDERS

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of a clean environment that has the wheel, and the dependencies borrowed from this one."""
    folder = tmp_path_factory.mktemp("clean")
    venv.create(folder, with_pip=False, symlinks=True)
    python = folder / "bin" / "python"
    code = "import sysconfig; print(sysconfig.get_path('purelib'))"
    site = Path(subprocess.run([python, "-c", code], capture_output=True, text=True, check=True).stdout.strip())
    with ZipFile(wheel) as archive:
        archive.extractall(site)
    _borrow_dependencies(site)
    return python


def _borrow_dependencies(site: Path) -> None:
    """Link every installed package but our own: a .pth would bring the editable install along."""
    for package in Path(sysconfig.get_path("purelib")).iterdir():
        ours = package.name.startswith(("mimics_app", "_mimics_app", "__pycache__"))
        if not ours and package.suffix != ".pth" and not (site / package.name).exists():
            (site / package.name).symlink_to(package)


def _run(python: Path, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    command = [str(python), *arguments]
    return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)


def test_wheel_holds_every_data_file(wheel: Path) -> None:
    held = {name.removeprefix("mimics_app/data/") for name in ZipFile(wheel).namelist()}
    wanted = {
        file.relative_to(ROOT).as_posix()
        for folder in FOLDERS
        for file in (ROOT / folder).rglob("*")
        if file.is_file() and "__pycache__" not in file.parts
    }
    assert wanted
    assert wanted <= held


def test_wheel_holds_every_file_of_the_package_and_the_licence(wheel: Path) -> None:
    """Modules, and the tables, templates and scripts beside them."""
    held = set(ZipFile(wheel).namelist())
    files = {file for file in (ROOT / "mimics_app").rglob("*") if file.is_file() and "__pycache__" not in file.parts}
    assert {file.relative_to(ROOT).as_posix() for file in files} <= held
    assert any(name.endswith("licenses/LICENSE") for name in held)
    assert not [name for name in held if name.startswith(("tests/", "docs/")) or name.endswith(".pyc")]


def test_wheel_finds_its_own_data_outside_the_repository(installed: Path, tmp_path: Path) -> None:
    code = (
        "import mimics_app; from mimics_app.contracts.resources import root; print(mimics_app.__file__); print(root())"
    )
    done = _run(installed, "-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    package, root = done.stdout.splitlines()
    assert not Path(package).is_relative_to(ROOT)
    assert Path(root) == Path(package).parent / "data"
    assert (Path(root) / "scenes" / "wavy_tunnel.json").is_file()


def test_command_line_of_the_wheel(installed: Path, tmp_path: Path) -> None:
    assert _run(installed, "-m", "mimics_app", "--help", cwd=tmp_path).returncode == 0
    scene = ROOT / "scenes" / "wavy_tunnel.json"
    done = _run(installed, "-m", "mimics_app", "check", str(scene), "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["command"] == "check"


def test_editable_install_sees_the_same_files(tmp_path: Path) -> None:
    """A checkout is used where it lies: no copy of shaders or scenes that could grow old."""
    code = "from mimics_app.contracts.resources import root; print(root())"
    done = _run(Path(sys.executable), "-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert Path(done.stdout.strip()) == ROOT
