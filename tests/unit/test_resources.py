"""Where the data lies: a checkout, an installed package, an installation that lost it."""

from __future__ import annotations

from pathlib import Path

import pytest

from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.system import resources


def _place(folder: Path) -> None:
    for name in resources.FOLDERS:
        (folder / name).mkdir(parents=True)


def _pretend_package_is(monkeypatch: pytest.MonkeyPatch, package: Path) -> None:
    monkeypatch.setattr(resources, "__file__", str(package / "contracts" / "system" / "resources.py"))


def test_checkout_finds_its_own_folders() -> None:
    root = resources.root()
    assert (root / "scenes" / "wavy_tunnel.json").is_file()
    assert root == Path(__file__).resolve().parents[2]


def test_wheel_data_wins_over_neighbours(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """site-packages may hold folders called assets or scenes of somebody else."""
    package = tmp_path / "site-packages" / "mimics_app"
    _place(package / "data")
    _place(package.parent)
    _pretend_package_is(monkeypatch, package)
    assert resources.root() == package / "data"


def test_incomplete_installation_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    package = tmp_path / "mimics_app"
    (package / "data" / "shaders").mkdir(parents=True)
    _pretend_package_is(monkeypatch, package)
    with pytest.raises(MimicsError, match="scenes"):
        resources.root()
