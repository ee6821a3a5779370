"""Third-party test data beside the repository; never part of it. Tests that need it are skipped where it is absent."""

from __future__ import annotations

from pathlib import Path

import pytest

SHARED_DATA = Path(__file__).parents[2].parent / "shared" / "data"


def shared_folder(name: str) -> Path:
    """A folder of the shared data, e.g. "gltf"; skips the test where it is absent."""
    folder = SHARED_DATA / name
    if not folder.is_dir():
        pytest.skip(f"the shared test data {name} is not beside this checkout")
    return folder
