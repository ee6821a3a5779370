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

from mimics_app.contracts.system.resources import FOLDERS

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


def _built(into: Path, epoch: int, **environment: str) -> dict[str, bytes]:
    """Wheel and sdist, built at a time that the files state."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-t", "wheel", "-d", str(into)]
    named = {**os.environ, "SOURCE_DATE_EPOCH": str(epoch), **environment}
    subprocess.run(command, cwd=ROOT, env=named, check=True, capture_output=True)
    return {file.name: file.read_bytes() for file in into.iterdir()}


def test_wheel_and_sdist_are_the_same_bytes_whenever_they_are_built(tmp_path: Path) -> None:
    """The zone of the clock and the seed of hashes are others; another date of the source gives other files."""
    first = _built(tmp_path / "first", 1_700_000_000, TZ="UTC", PYTHONHASHSEED="1")
    second = _built(tmp_path / "second", 1_700_000_000, TZ="Pacific/Auckland", PYTHONHASHSEED="2")
    assert {Path(name).suffix for name in first} == {".whl", ".gz"}
    assert first == second
    assert _built(tmp_path / "other", 1_600_000_000) != first, "they state the date of the source"


KINDS = {
    "assets": {".glb", ".jpg", ".json", ".mo", ".png", ".po", ".pot", ".txt"},
    "scenes": {".csv", ".json"},
    "shaders": {".frag", ".glsl", ".json", ".vert"},
}
"""Data folder: the kinds of files in it; a program there would be content's maker, which stays in the checkout."""


def _files(folder: str) -> set[str]:
    files = {file for file in (ROOT / folder).rglob("*") if file.is_file() and "__pycache__" not in file.parts}
    return {file.relative_to(ROOT).as_posix() for file in files}


def test_wheel_holds_the_package_its_data_and_its_licence_and_nothing_else(wheel: Path) -> None:
    """Modules, and the tables, templates and scripts beside them; models, but not the builders that make them."""
    held = set(ZipFile(wheel).namelist())
    data = {f"mimics_app/data/{file}" for folder in FOLDERS for file in _files(folder)}
    makers = {f"mimics_app/data/{file}" for file in _files("assets/builders")}
    assert len(makers) > 50
    rest = held - _files("mimics_app") - (data - makers)
    assert not (_files("mimics_app") | (data - makers)) - held
    about = {name.partition("/")[2] for name in rest if name.partition("/")[0].endswith(".dist-info")}
    assert about == {"METADATA", "RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE"}
    assert len(about) == len(rest)


@pytest.mark.parametrize("folder", FOLDERS)
def test_data_of_the_wheel_is_of_known_kinds(wheel: Path, folder: str) -> None:
    inside = f"mimics_app/data/{folder}/"
    assert {Path(name).suffix for name in ZipFile(wheel).namelist() if name.startswith(inside)} == KINDS[folder]


def test_wheel_finds_its_own_data_outside_the_repository(installed: Path, tmp_path: Path) -> None:
    code = (
        "import mimics_app; from mimics_app.contracts.system import resources as found;"
        "print(mimics_app.__file__); print(found.root())"
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


def test_an_installation_says_that_it_builds_no_content(installed: Path, tmp_path: Path) -> None:
    """Even where somebody else's folder of that name lies in the way."""
    (tmp_path / "assets" / "builders").mkdir(parents=True)
    (tmp_path / "assets" / "builders" / "catalogue.py").write_text("find_builders = list\n")
    for arguments in (("build", "city"), ("list",)):
        done = _run(installed, "-m", "mimics_app", "assets", *arguments, cwd=tmp_path)
        assert done.returncode == 2
        (line,) = done.stderr.splitlines()
        assert "no builders" in line and "checkout" in line
    bowl = ROOT / "assets" / "models" / "touch" / "bowl.glb"
    done = _run(installed, "-m", "mimics_app", "assets", "levels", str(bowl), cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_editable_install_sees_the_same_files(tmp_path: Path) -> None:
    """A checkout is used where it lies: no copy of shaders or scenes that could grow old."""
    code = "from mimics_app.contracts.system.resources import root; print(root())"
    done = _run(Path(sys.executable), "-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert Path(done.stdout.strip()) == ROOT
