"""Packages of other people, made for a test: a folder that goes before others on the module path of a process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

__all__ = ["build_wheel", "write_package"]


def build_wheel(example: Path, folder: Path) -> Path:
    """The folder in which the wheel of an example lies unpacked; no registry is asked."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder / "wheel")]
    subprocess.run(command, cwd=example, check=True, capture_output=True)
    with ZipFile(next((folder / "wheel").glob("*.whl"))) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def write_package(folder: Path, name: str, source: str, entry_points: str) -> Path:
    """The folder in which a package of one module lies as if it were installed."""
    about = folder / f"{name}-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name.replace('_', '-')}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(entry_points)
    (folder / f"{name}.py").write_text(source)
    return folder
