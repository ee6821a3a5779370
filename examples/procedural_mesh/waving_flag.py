"""A flag whose vertices are computed for every frame, and a wave that runs through a row of posts, one range a frame.

Run it from the repository's root: python examples/procedural_mesh/waving_flag.py FOLDER [FRAMES]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

import mimics_app as mimics
from mimics_app.world.content.meshes.mesh import MeshData, compute_normals
from mimics_app.world.content.meshes.mesh_buffer import MeshBuffer
from mimics_app.world.content.meshes.primitives import box
from mimics_app.world.content.world import World

SCENE = Path(__file__).with_name("flag.json")
WIDTH, HEIGHT, COLUMNS, ROWS = 1.5, 0.9, 48, 24
POSTS = 24
STEP = 1.0 / 30.0
"""Time from picture to picture [s]."""


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


def add_meshes(world: World) -> tuple[MeshBuffer, MeshBuffer]:
    """Put the flag at its pole and the posts before it; their vertices may be written from now on."""
    for name, mesh, material, place in (
        ("flag", make_flag(), "cloth", (-0.77, 1.85, 0.0)),
        ("posts", make_posts(), "wood", (0.0, 0.0, 0.0)),
    ):
        world.set_mesh(name, mesh)
        world.root.create_child(name, place).create_entity(name, material)
    return world.open_mesh("flag"), world.open_mesh("posts")


def draw(folder: Path, frames: int, size: tuple[int, int] = (640, 360)) -> list[Path]:
    """Draw the scene frame by frame into PNG files."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"frame_{number:05d}.png" for number in range(frames)]
    with mimics.open(SCENE, record=False) as session:
        flag, posts = add_meshes(session.world)
        for number, file in enumerate(files):
            wave(flag, number * STEP)
            lift(posts, number)
            session.step(STEP)
            Image.fromarray(session.picture(*size, board=False)).save(file)
    return files


def declare(mesh: MeshBuffer) -> list[str]:
    """How the driver sees a vertex, a line for each attribute."""
    return [
        f"{each.attribute}: {each.components} x {each.format} at byte {each.offset} of {declaration.stride}"
        for declaration in mesh.declarations
        for each in declaration.elements
    ]


if __name__ == "__main__":
    with mimics.open(SCENE, record=False) as opened:
        print("\n".join(declare(add_meshes(opened.world)[0])))
    for written in draw(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 30):
        print(written)
