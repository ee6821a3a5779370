"""The folder for machine code and pages: this user's alone, whatever is in its place."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from mimics_app.compiled import private_folder


@pytest.fixture
def only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """One candidate, in an empty folder; temporary folders lie beside it."""
    monkeypatch.setattr(private_folder, "_candidates", lambda: iter([tmp_path / "mimics"]))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    return tmp_path / "mimics"


def test_a_new_folder_is_open_to_its_user_alone(only: Path) -> None:
    assert private_folder.private_folder() == only
    assert only.stat().st_mode & 0o777 == 0o700


def test_a_folder_of_this_user_that_stood_open_is_closed(only: Path) -> None:
    only.mkdir(mode=0o777)
    only.chmod(0o777)
    assert private_folder.private_folder() == only
    assert only.stat().st_mode & 0o777 == 0o700


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can make a folder of another user")
def test_a_folder_that_another_user_made_first_is_not_taken(only: Path) -> None:
    only.mkdir()
    os.chown(only, 12346, 12346)
    fresh = private_folder.private_folder()
    assert fresh is not None and fresh != only and fresh.stat().st_uid == os.geteuid()
    assert fresh.stat().st_mode & 0o777 == 0o700
    assert os.environ["NUMBA_CACHE_DIR"] == str(fresh)


def test_a_link_is_not_followed(only: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    only.symlink_to(elsewhere)
    assert private_folder.private_folder() not in (only, elsewhere)


def test_a_file_in_the_way_is_passed_over(only: Path) -> None:
    only.write_text("in the way")
    fresh = private_folder.private_folder()
    assert fresh is not None and fresh.is_dir()


def test_without_any_writable_place_there_is_no_cache(only: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> str:
        raise OSError("read-only file system")

    only.write_text("in the way")
    monkeypatch.setattr("tempfile.mkdtemp", refuse)
    assert private_folder.private_folder() is None
