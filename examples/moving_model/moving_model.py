"""Play a clip of a glTF model and draw it: python moving_model.py MODEL CLIP JOINT FOLDER."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, save_png
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.extent import world_extent
from mimics_app.world.content.meshes.primitives import sphere
from mimics_app.world.files.scene.model_world import load_model_world

SIZE = (480, 480)


def draw(model: Path, clip: str, joint: str, folder: Path, frames: int = 12) -> list[Path]:
    """Frames of one time through the clip, as PNG files."""
    world = load_model_world(model)
    animator = next(iter(world.motion.animators.values()))
    playing = animator.play(clip)
    held = world.node(int(animator.rig.entities[animator.rig.slot(joint)]))
    world.set_mesh("lamp", sphere(0.05))
    lamp = held.create_child("lamp")  # what hangs on a joint moves with it
    lamp.create_entity("lamp")
    lamp.create_light("point", colour=(1.0, 0.8, 0.5), intensity=0.3)
    world.root.create_child().create_light("ambient", intensity=0.5)
    world.update()
    extent = world_extent(world)
    assert extent is not None, "the model shows nothing"
    middle, reach = 0.5 * (extent[0] + extent[1]), float(np.linalg.norm(extent[1] - extent[0]))
    view = View(compose_look_at(middle + (0.3, 0.2, reach), middle), (-0.6, 0.6, -0.6, 0.6), (0, 0, *SIZE))
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    with open_offscreen("auto", SIZE) as surface:
        renderer = Renderer(surface, world, RenderSettings(fog_density=0.0))
        for number in range(frames):
            world.motion.time = playing.clip.duration * number / frames
            world.update()
            renderer.draw_finished([view])
            files.append(folder / f"{clip}_{number:02d}.png")
            save_png(surface, files[-1])
        renderer.release()
    return files


if __name__ == "__main__":
    for written in draw(Path(sys.argv[1]), sys.argv[2], sys.argv[3], Path(sys.argv[4])):
        print(written)
