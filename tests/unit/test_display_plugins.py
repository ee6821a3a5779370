"""Displays of every kind, and of other packages, by one conformance kit; --display takes a plug-in like any other."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pytest
from PIL import Image

from mimics_app.app import cli
from mimics_app.contracts.display_choice import DISPLAY_KINDS, DisplayChoice
from mimics_app.rendering.visual.displays.catalogue import make_display
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
"""A table that is looked at from two edges: the picture twice, one above the other."""
from mimics_app.contracts.display_port import Eye
from mimics_app.rendering.visual.displays.desktop import DesktopDisplay, compute_tangents


class Table(DesktopDisplay):
    kind = "table"

    def eyes(self, viewpoint, drawn, display_ns):
        width, height = drawn[0], drawn[1] // 2
        near = compute_tangents(viewpoint.vertical_fov, (width, height))
        pose = viewpoint.world_from_head
        return [Eye(n, pose, near, (0, y, width, height)) for n, y in (("near", 0), ("far", height))]


def build(request):
    assert request.ipd > 0.0 and request.screen_distance > 0.0
    return Table()
'''
GROUP = "[mimics_app.displays]\ntable = lab_with_a_table:build\nlost = lab_with_a_table:missing\n"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_with_a_table", TABLE, GROUP)))


def file_of(kind: str, folder: Path) -> str:
    if DISPLAY_KINDS.get(kind) != "must":
        return ""
    file = folder / "walls.json"
    file.write_text(json.dumps(WALLS))
    return str(file)


@pytest.mark.parametrize("kind", [*(kind for kind in DISPLAY_KINDS if kind != "openxr"), "table"])
def test_display_keeps_the_contract(kind: str, installed: None, tmp_path: Path) -> None:
    """OpenXR needs a runtime: tests/golden/test_openxr.py."""
    choice = DisplayChoice(kind, file_of(kind, tmp_path))
    display, notice = make_display(choice, DisplaySettings(), SimpleNamespace(backend="egl"))
    assert (display.kind, notice) == (kind, "")
    check_display(display)


def test_plug_in_is_rendered_listed_and_reported(
    installed: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["render", "wavy_tunnel", "--size", "64x48", "--seconds", "0.1", "--output", str(tmp_path)]
    assert cli.main([*words, "--display", "table", "--json"]) == 0
    files = json.loads(capsys.readouterr().out)["files"]
    assert files == ["frame_00000.png", "frame_00000_near.png", "frame_00000_far.png"]
    with Image.open(tmp_path / files[1]) as near, Image.open(tmp_path / files[2]) as far:
        assert near.size == far.size == (64, 24)
    assert cli.main([*words, "--display", "lost"]) == 4
    assert "its plug-in lab_with_a_table:missing cannot be imported" in capsys.readouterr().err
    assert cli.main([*words, "--display", "tabel"]) == 2
    assert 'did you mean "table"' in capsys.readouterr().err
