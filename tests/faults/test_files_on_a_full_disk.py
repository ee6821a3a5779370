"""A file that does not fit on the disk is named, and what was written of it is removed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.study.tables import write_table
from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.lab.sweep.store import ChunkStore
from mimics_app.rendering.visual.surfaces.headless import write_png
from mimics_app.world.files.gltf.writer import GltfWriter
from tests.support.full_disk import largest_file

ROOT = Path(__file__).resolve().parents[2]
LIMIT = 40
"""Largest file [bytes]."""


def put_chunk(file: Path) -> None:
    ChunkStore(file, "identity").put((0, 1), bytes(2 * LIMIT))


@pytest.mark.parametrize(
    "write",
    [
        put_chunk,
        lambda file: write_png(np.zeros((32, 32, 3), np.uint8), file),
        lambda file: GltfWriter("test").write(file),
        lambda file: write_table(file, [{"subject": "s" * 2 * LIMIT}]),
    ],
    ids=["chunk of a sweep", "picture", "model", "table of a study"],
)
def test_file_that_does_not_fit_is_named_and_removed(tmp_path: Path, write: Callable[[Path], None]) -> None:
    with largest_file(LIMIT), pytest.raises(OSError, match="too large") as caught:
        write(tmp_path / "result")
    assert Path(caught.value.filename).relative_to(tmp_path).parts[0].startswith("result")
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_levels_that_do_not_fit_are_one_line_with_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bowl = ROOT / "assets/models/touch/bowl.glb"
    with largest_file(4096):
        assert main(["assets", "levels", str(bowl), "--out", str(tmp_path)]) == 3
    assert f"mimics: {tmp_path / 'bowl_levels.glb'}: File too large" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_file_that_cannot_be_opened_keeps_its_content(tmp_path: Path) -> None:
    file = tmp_path / "kept"
    file.write_text("old")
    with pytest.raises(PermissionError), whole_file(file):
        raise PermissionError(13, "Permission denied", str(file))
    assert file.read_text() == "old"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_device_is_not_removed(tmp_path: Path) -> None:
    link = tmp_path / "device"
    link.symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left") as caught, whole_file(link):
        link.write_text("x")
    assert caught.value.filename == str(link)
    assert link.is_symlink()
