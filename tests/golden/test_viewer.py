"""`mimics view` as a person meets it: pictures, sheets, and a window that is clicked, dragged and typed into."""

from __future__ import annotations

from pathlib import Path

from tests.support.gltf_maker import *  # noqa: F403

_ROOT = Path(__file__).parents[2]
