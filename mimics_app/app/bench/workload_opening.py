"""Workloads of `mimics bench render` by name; modules of the other workloads are imported by the one that is opened.

city            movement along a street, 1.4 m per frame
nodes           cubes under groups, all of which move in every frame
crowd           people who walk on the spot, each at a phase of its own
walk            the product's own city as in its scene, with shadows, sky and all materials, at walking pace
people          the same with a hundred people on its sidewalks
people_full     people without levels of detail and without updates by distance
particles       ten thousand particles
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from mimics_app.contracts.errors import SceneError, UsageError

if TYPE_CHECKING:
    from mimics_app.app.bench.render_workloads import Workload

__all__ = ["WORKLOADS", "open_workload"]

T = TypeVar("T")


def open_workload(name: str, folder: Path | None, count: int) -> Workload:
    """Load a workload.

    Args:
        name: One of `WORKLOADS`.
        folder: Folder of the files of the workloads; None where it is not known.
        count: Number of nodes, people or particles; 0: that of the peers.

    Raises:
        UsageError: The folder is not known, or the file is missing.
        SceneError: The file is faulty.
    """
    return _OPENERS[name](folder, count)


def _open_city(folder: Path | None, count: int) -> Workload:
    from mimics_app.app.bench.render_workloads import City, light_up
    from mimics_app.world.files.scene.model_world import load_model_world

    world = _from_file(folder, "city.glb", load_model_world)
    light_up(world)
    return City(world, len(world.transforms))


def _open_nodes(folder: Path | None, count: int) -> Workload:
    from mimics_app.app.bench.render_workloads import PEERS_NODES, Nodes

    return _from_file(folder, "cube.glb", lambda file: Nodes(file, count or PEERS_NODES))


def _open_crowd(folder: Path | None, count: int) -> Workload:
    from mimics_app.app.bench.render_workloads import PEERS_PEOPLE, Crowd

    return _from_file(folder, "character.glb", lambda file: Crowd(file, count or PEERS_PEOPLE))


def _open_walk(folder: Path | None, count: int) -> Workload:
    from mimics_app.app.bench.render_workloads import Walk

    return Walk()


def _open_people(folder: Path | None, count: int, *, full: bool = False) -> Workload:
    from mimics_app.app.bench.people_workload import ON_SIDEWALKS, People

    return People(count or ON_SIDEWALKS, full)


def _open_people_full(folder: Path | None, count: int) -> Workload:
    return _open_people(folder, count, full=True)


def _open_particles(folder: Path | None, count: int) -> Workload:
    from mimics_app.app.bench.particles_workload import Fountain

    return Fountain(count)


def _from_file(folder: Path | None, name: str, load: Callable[[Path], T]) -> T:
    if folder is None:
        raise UsageError("the folder of the workloads is not known", "name it by --data or RENDER_DATA")
    file = folder / name
    try:
        return load(file)
    except SceneError as error:
        if file.is_file():
            raise
        raise UsageError(f"there is no {file}", "name the folder of the workloads by --data or RENDER_DATA") from error


_OPENERS: Mapping[str, Callable[[Path | None, int], Workload]] = {
    "city": _open_city,
    "nodes": _open_nodes,
    "crowd": _open_crowd,
    "walk": _open_walk,
    "people": _open_people,
    "people_full": _open_people_full,
    "particles": _open_particles,
}

WORKLOADS = tuple(_OPENERS)
"""Names of the workloads."""
