"""Golden pictures: --regenerate writes them anew instead of comparing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from mimics_app.rendering.visual.surfaces.rasteriser import without_software

_PICTURES = Path(__file__).parent / "pictures"
LEVEL = 1
SHARE = 0.999


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--regenerate", action="store_true", help="write golden pictures anew instead of comparing")
    parser.addoption("--nosoftware", action="store_true", help="draw as on a graphics card, whatever the driver is")


@pytest.fixture(autouse=True)
def _as_on_a_card(request: pytest.FixtureRequest) -> Iterator[None]:
    """Without the room for drawing in software, where that is asked for; tests of what is in it are left out."""
    if not request.config.getoption("--nosoftware", default=False):
        yield
        return
    if request.node.get_closest_marker("software"):
        pytest.skip("this is about drawing in software")
    with without_software():
        yield


def compare_pictures(
    ours: NDArray[np.uint8], theirs: NDArray[np.uint8], level: int = LEVEL
) -> tuple[float, NDArray[np.uint8]]:
    """Share of pixels that agree within `level` of 255 in every channel, and the difference, 16 times as bright."""
    away = np.abs(ours[..., :3].astype(int) - theirs[..., :3].astype(int))
    return float((away.max(axis=-1) <= level).mean()), np.clip(16 * away, 0, 255).astype(np.uint8)


@pytest.fixture
def assert_same(tmp_path: Path):
    """Compare two pictures; where they differ, both and their difference are kept."""

    def check(
        ours: NDArray[np.uint8], theirs: NDArray[np.uint8], what: str, level: int = LEVEL, wanted: float = SHARE
    ) -> None:
        assert ours.shape[:2] == theirs.shape[:2], what
        share, difference = compare_pictures(ours, theirs, level)
        if share < wanted:
            for name, pixels in (("ours", ours), ("theirs", theirs), ("difference", difference)):
                Image.fromarray(pixels[..., :3]).save(tmp_path / f"{name}.png")
        assert share >= wanted, f"{what}: {100.0 * (1.0 - share):.3f} % of pixels differ; see {tmp_path}/difference.png"

    return check


@pytest.fixture
def assert_golden(request: pytest.FixtureRequest, assert_same):
    """Compare a picture with the one of that name under tests/golden/pictures."""

    def check(ours: NDArray[np.uint8], name: str, level: int = LEVEL, wanted: float = SHARE) -> None:
        file = _PICTURES / f"{name}.png"
        if request.config.getoption("--regenerate", default=False):
            file.parent.mkdir(exist_ok=True)
            Image.fromarray(ours[..., :3]).save(file, optimize=True)
            pytest.skip(f"wrote {file.name}; look at it before it is committed")
        with Image.open(file) as picture:
            assert_same(ours, np.array(picture.convert("RGB")), name, level, wanted)

    return check
