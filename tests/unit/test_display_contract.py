"""Displays of every kind, and of another package, by one conformance kit."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from mimics_app.contracts.ports.display_choice import DISPLAY_KINDS, DisplayChoice, kind_of_display
from mimics_app.rendering.visual.displays.display_kinds import make_display
from mimics_app.world.components.systems import DisplaySettings
from tests.support.display_kit import check_display
from tests.support.plugin_site import write_package

WALLS = {
    "format": "mimics.walls/1",
    "walls": [
        {"name": "front", "lower_left": [-1, 0.6, -1.5], "lower_right": [1, 0.6, -1.5], "upper_left": [-1, 2.2, -1.5]}
    ],
}
TABLE = '''
"""A table that is looked at from two edges: the picture twice, one above the other; or one on top of the other."""
from mimics_app.contracts.ports.display_port import Eye
from mimics_app.rendering.visual.displays.desktop import DesktopDisplay, compute_tangents


class Table(DesktopDisplay):
    def __init__(self, request):
        super().__init__()
        self.kind = request.kind

    def eyes(self, viewpoint, drawn, display_ns):
        width, height = drawn[0], drawn[1] // 2
        frustum, pose = compute_tangents(viewpoint.vertical_fov, (width, height)), viewpoint.world_from_head
        far = 0 if self.kind == "heap" else height
        return [Eye(name, pose, frustum, (0, y, width, height)) for name, y in (("near", 0), ("far", far))]
'''
GROUP = "[mimics_app.displays]\ntable = lab_with_a_table:Table\nheap = lab_with_a_table:Table\n"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_with_a_table", TABLE, GROUP)))


def checked(kind: str, folder: Path) -> None:
    file = folder / "walls.json"
    file.write_text(json.dumps(WALLS))
    choice = DisplayChoice(kind, str(file) if kind_of_display(kind).file == "must" else "")
    display, notice = make_display(choice, DisplaySettings(), SimpleNamespace(backend="egl"))
    assert (display.kind, notice) == (kind, "")
    check_display(display)


@pytest.mark.parametrize("kind", [*(kind for kind in DISPLAY_KINDS if kind != "openxr"), "table"])
def test_display_keeps_the_contract(kind: str, installed: None, tmp_path: Path) -> None:
    """OpenXR needs a runtime: tests/golden/test_openxr.py."""
    checked(kind, tmp_path)


def test_eyes_that_draw_the_same_pixels_are_found(installed: None, tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match="no two eyes draw the same pixel"):
        checked("heap", tmp_path)
