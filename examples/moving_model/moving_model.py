"""Play a clip of a glTF model with a lamp on one of its joints: python moving_model.py MODEL CLIP JOINT FOLDER."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from PIL import Image

import mimics_app as mimics
from mimics_app.world.content.meshes.primitives import sphere

SIZE = (480, 480)
STEP = 0.1
"""Time from picture to picture [s]."""


def write_scene(model: Path, clip: str) -> Path:
    """Write a scene beside the model, in which it plays the clip."""
    scene = {
        "format": "mimics-scene",
        "version": 1,
        "assets": {"person": {"uri": model.name}},
        "entities": [
            {"id": "person", "components": {"mesh": {"source": "person"}, "animation": {"layers": [{"clip": clip}]}}},
            {"id": "robot", "components": {"robot": {}}},  # every session has one; nothing here can be touched
            {"id": "sky", "components": {"light": {"kind": "ambient", "intensity": 0.5}}},
            {
                "id": "eye",
                "transform": {"translation": [0.4, 1.1, 2.4]},
                "components": {"camera": {"target": [0.0, 0.9, 0.0]}},
            },
        ],
    }
    file = model.with_name(f"{model.stem}_{clip}.json")
    file.write_text(json.dumps(scene, indent=1), encoding="utf-8")
    return file


def draw(model: Path, clip: str, joint: str, folder: Path, frames: int = 12) -> list[Path]:
    """Draw frames of the clip as PNG files."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{clip}_{number:02d}.png" for number in range(frames)]
    with mimics.open(write_scene(model, clip), record=False) as session:
        lamp = session.world.find(f"person/{joint}").create_child("lamp")  # what hangs on a joint moves with it
        session.world.set_mesh("lamp", sphere(0.05))
        lamp.create_entity("lamp")
        lamp.create_light("point", colour=(1.0, 0.8, 0.5), intensity=0.3)
        for file in files:
            session.step(STEP)
            Image.fromarray(session.picture(*SIZE, board=False)).save(file)
    return files


if __name__ == "__main__":
    for written in draw(Path(sys.argv[1]), sys.argv[2], sys.argv[3], Path(sys.argv[4])):
        print(written)
