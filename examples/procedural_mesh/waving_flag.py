"""A flag whose vertices are computed for every frame, and a wave that runs through a row of posts, one range a frame.

Run it from the repository's root: python examples/procedural_mesh/waving_flag.py FOLDER [FRAMES]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.frame_set import FrameSet, render_frames
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.mesh import MeshData, compute_normals
from mimics_app.world.content.meshes.mesh_buffer import MeshBuffer
from mimics_app.world.content.meshes.primitives import box, cylinder, plane
from mimics_app.world.content.world import World

WIDTH, HEIGHT, COLUMNS, ROWS = 1.5, 0.9, 48, 24
POSTS = 24
FRAMES_PER_SECOND = 30.0


def make_flag() -> MeshData:
    """A sheet hanging in the xy plane from x = 0, both its colours given by its vertices."""
    x, y = np.meshgrid(np.linspace(0.0, WIDTH, COLUMNS + 1), np.linspace(0.5 * HEIGHT, -0.5 * HEIGHT, ROWS + 1))
    positions = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    first = (np.arange(ROWS)[:, None] * (COLUMNS + 1) + np.arange(COLUMNS)).reshape(-1, 1)
    indices = (first + [0, COLUMNS + 1, 1, 1, COLUMNS + 1, COLUMNS + 2]).ravel().astype(np.uint32)
    blue, cream = (0.03, 0.22, 0.45, 1.0), (0.92, 0.86, 0.70, 1.0)
    away = np.hypot(positions[:, 0] - 0.5 * WIDTH, positions[:, 1])
    ring = (np.abs(away - 0.22) < 0.05) | (np.abs(positions[:, 1]) > 0.36)
    colours = np.where(ring[:, None], cream, blue)
    return MeshData(positions, compute_normals(positions, indices), indices, None, colours).validated()


def wave(flag: MeshBuffer, seconds: float) -> None:
    """Let the wind run through the flag: written where the driver's buffer has it, then reported."""
    x, y = flag.positions[:, 0], flag.positions[:, 1]
    phase = 5.0 * x - 6.0 * seconds + 1.5 * y
    flag.positions[:, 2] = 0.09 * x * np.sin(phase) + 0.03 * x * np.sin(2.3 * phase + 1.0)
    flag.normals[:] = compute_normals(flag.positions, flag.indices)
    flag.update()


def make_posts() -> MeshData:
    """A row of boxes in one mesh: vertices 24 i to 24 i + 23 are the i-th post."""
    post = box(0.05, 0.3, 0.05)
    count = len(post.positions)
    places = np.stack([np.linspace(-1.6, 1.6, POSTS), np.full(POSTS, 0.15), np.full(POSTS, 0.9)], axis=1)
    positions = (post.positions + places[:, None]).reshape(-1, 3)
    indices = (post.indices + count * np.arange(POSTS)[:, None]).ravel()
    return MeshData(positions, np.tile(post.normals, (POSTS, 1)), indices).validated()


def lift(posts: MeshBuffer, number: int) -> None:
    """Raise or lower a single post: only its 24 vertices are sent."""
    size = len(posts.positions) // POSTS
    first = size * (number % POSTS)
    up = 0.12 if (number // POSTS) % 2 == 0 else -0.12
    posts.positions[first : first + size, 1] += up
    posts.update(first, size)


def make_world() -> World:
    """A pole with the flag, the posts, a floor, a sun and an eye."""
    world = World()
    world.environment = Sky((0.20, 0.40, 0.75), (0.70, 0.80, 0.90), (0.25, 0.24, 0.20), 0.7)
    world.set_material(Material("cloth", base_colour=(1.0, 1.0, 1.0, 1.0), roughness=0.9, double_sided=True))
    world.set_material(Material("grass", base_colour=(0.22, 0.32, 0.12, 1.0), roughness=1.0))
    world.set_material(Material("wood", base_colour=(0.45, 0.30, 0.16, 1.0), roughness=0.7))
    world.meshes |= {
        "flag": make_flag(),
        "posts": make_posts(),
        "pole": cylinder(0.03, 2.4),
        "floor": plane(40.0, 40.0),
    }
    root = world.root
    root.create_child("floor").create_entity("floor", "grass").subentities[0].casts_shadow = False
    root.create_child("pole", (-0.8, 1.2, 0.0)).create_entity("pole", "wood")
    root.create_child("flag", (-0.77, 1.85, 0.0)).create_entity("flag", "cloth")
    root.create_child("posts").create_entity("posts", "wood")
    sun = root.create_child("sun", (-2.0, 4.0, 3.0))
    sun.look_at((0.0, 0.8, 0.0))
    sun.create_light("directional", colour=(1.0, 0.95, 0.85), intensity=1.3, casts_shadow=1)
    eye = root.create_child("eye", (0.6, 1.5, 3.6))
    eye.look_at((0.0, 1.05, 0.0))
    eye.create_camera(math.radians(45.0))
    world.update()
    return world


def draw(folder: Path, frames: int, size: tuple[int, int] = (640, 360)) -> FrameSet:
    """Draw the scene frame by frame into PNG files."""
    world = make_world()
    flag, posts = world.open_mesh("flag"), world.open_mesh("posts")
    done: set[int] = set()

    def views(number: int) -> list[View]:
        wave(flag, number / FRAMES_PER_SECOND)
        if number not in done:
            lift(posts, number)
            done.add(number)
        world.update()
        return list(desktop_views(world.cameras[0], size))

    with open_offscreen("auto", size) as surface:
        renderer = Renderer(surface, world, RenderSettings(shadow_size=1024, fog_density=0.02))
        try:
            return render_frames(renderer, surface, frames, views, folder)
        finally:
            renderer.release()


def declare(mesh: MeshBuffer) -> list[str]:
    """How the driver sees a vertex, a line for each attribute."""
    return [
        f"{each.attribute}: {each.components} x {each.format} at byte {each.offset} of {declaration.stride}"
        for declaration in mesh.declarations
        for each in declaration.elements
    ]


if __name__ == "__main__":
    print("\n".join(declare(make_world().open_mesh("flag"))))
    for file in draw(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 30).files:
        print(file)
