"""Files for --display are found where a person stands, with what is wrong with them."""

from __future__ import annotations

import json
from pathlib import Path

from mimics_app.app.installation.display_files import find_display_files


def test_walls_and_headsets_are_found_and_other_files_are_not(tmp_path: Path) -> None:
    wall = {"name": "front", "lower_left": [-1, 0, -1], "lower_right": [1, 0, -1], "upper_left": [-1, 2, -1]}
    room = tmp_path / "room"
    room.mkdir()
    (room / "walls.json").write_text(json.dumps({"format": "mimics.walls/1", "walls": [wall]}))
    (tmp_path / "bent.json").write_text(
        json.dumps({"format": "mimics.walls/1", "walls": [wall | {"upper_left": [1, 1, 1]}]})
    )
    (tmp_path / "glasses.json").write_text(json.dumps({"format": "mimics.headset/1"}))
    (tmp_path / "scene.json").write_text(json.dumps({"format": "mimics.scene/1"}))
    (tmp_path / "noise.json").write_bytes(bytes(range(256)))
    found = {one["write"]: one["error"] for one in find_display_files(tmp_path)}
    assert set(found) == {"cave:bent.json", "sim-hmd:glasses.json", "cave:room/walls.json"}
    assert "right angle" in found["cave:bent.json"]
    assert found["sim-hmd:glasses.json"] == found["cave:room/walls.json"] == ""
