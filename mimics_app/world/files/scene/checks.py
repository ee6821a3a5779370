"""Checks of a decoded scene: ids, parents, transforms, and the registered checks of components and sections."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Container, Mapping

from mimics_app.contracts.errors import MOST_SOUGHT, Issue, nearest
from mimics_app.world.components.registry import check_of_system, checks_of, limits, section_of
from mimics_app.world.content.meshes.mesh import FARTHEST
from mimics_app.world.files.gltf.nodes import MAX_DEPTH
from mimics_app.world.files.scene.scene import Scene, SceneEntity

__all__ = ["check_meaning"]


def check_meaning(scene: Scene) -> list[Issue]:
    """Return the faults of a decoded scene that its types do not exclude; the search ends after `MOST_SOUGHT`."""
    issues: list[Issue] = []
    for entity in scene.entities:
        issues += _check_id(scene, entity)
        issues += _check_transform(scene, entity)
    issues += _check_parents(scene)
    unbounded = _check_numbers(scene) + _check_depth(scene)
    if unbounded:
        return issues + unbounded
    for entity in scene.entities:
        if len(issues) >= MOST_SOUGHT:
            return issues
        for name, struct in entity.components.items():
            pointer = f"{entity.pointer}/components/{name}"
            for check in checks_of(name):
                found = check(struct, pointer, scene)
                issues += found
                if found:  # later checks may rely on this one
                    break
    return issues + _check_settings(scene)


def _check_settings(scene: Scene) -> list[Issue]:
    """Return the faults of systems and sections."""
    checks = [(check_of_system(name), struct) for name, struct in scene.systems.items()]
    sections = ((section_of(name), struct) for name, struct in scene.sections.items())
    checks += [(section.check, struct) for section, struct in sections if section is not None]
    return [issue for check, struct in checks if check is not None for issue in check(struct, scene)]


def _check_numbers(scene: Scene) -> list[Issue]:
    """Faults of component types that a scene has too many of."""
    counts = Counter(name for entity in scene.entities for name in entity.components)
    return [
        scene.issue("/entities", f'{counts[name]} entities have a "{name}"; at most {most} may')
        for name, most in limits().items()
        if counts[name] > most
    ]


def _check_id(scene: Scene, entity: SceneEntity) -> list[Issue]:
    first = scene.by_id[entity.id]
    if first is entity:
        return []
    what = f'the id "{entity.id}" is taken by {scene.place(f"{first.pointer}/id")}'
    return [scene.issue(f"{entity.pointer}/id", what, "choose another id")]


def _check_transform(scene: Scene, entity: SceneEntity) -> list[Issue]:
    issues = scene.check_rotation(f"{entity.pointer}/transform/rotation", entity.transform.rotation)
    issues += [
        scene.issue(f"{entity.pointer}/transform/scale/{i}", "a scale of 0 flattens the entity", "hide it instead")
        for i, factor in enumerate(entity.transform.scale)
        if factor == 0.0
    ]
    return issues


def _check_reach(scene: Scene) -> list[Issue]:
    """Return the first entity that its parents' scales make too large, or put too far away, to be drawn."""
    by_id, reach = scene.by_id, dict[str, tuple[float, float]]()
    for entity in scene.entities:
        path, name = _upwards(entity.id, by_id, reach)
        away, factor = reach.get(name, (0.0, 1.0)) if name is not None else (0.0, 1.0)
        for each in reversed(path):
            transform = by_id[each].transform
            away += factor * math.hypot(*transform.translation)
            factor *= max(map(abs, transform.scale))
            reach[each] = away, factor
            if not max(away, factor) <= FARTHEST:
                what = f"its parents' scales put it {away:g} m away, {factor:g} times as large: beyond {FARTHEST:g}"
                return [scene.issue(f"{by_id[each].pointer}/transform", what, "scale less")]
    return []


def _check_parents(scene: Scene) -> list[Issue]:
    issues, by_id = list[Issue](), scene.by_id
    for entity in scene.entities:
        if len(issues) >= MOST_SOUGHT:
            return issues
        if entity.parent is not None and entity.parent not in by_id:
            what, hint = f'no entity "{entity.parent}"', nearest(entity.parent, by_id)
            issues.append(scene.issue(f"{entity.pointer}/parent", what, hint))
    issues += _check_reach(scene)
    done: set[str] = set()
    for entity in scene.entities:
        path, name = _upwards(entity.id, by_id, done)
        if name in path:
            chain = " -> ".join((*path[path.index(name) :], name))
            issues.append(
                scene.issue(f"{by_id[name].pointer}/parent", f"hangs on itself: {chain}", "choose another parent")
            )
        done.update(path)
    return issues


def _upwards(name: str, by_id: Mapping[str, SceneEntity], known: Container[str]) -> tuple[list[str], str | None]:
    """Return an entity and its ancestors, and what ended the way: one of `known`, of the way (a loop), or nothing."""
    path: dict[str, None] = {}
    step: str | None = name
    while step is not None and step in by_id and step not in known and step not in path:
        path[step] = None
        step = by_id[step].parent
    return list(path), step


def _check_depth(scene: Scene) -> list[Issue]:
    """Return the first entity with too many ancestors: other checks walk its parents once for each entity."""
    by_id, depth = scene.by_id, dict[str, int]()
    for entity in scene.entities:
        path, name = _upwards(entity.id, by_id, depth)
        above = depth.get(name, 0) if name is not None else 0
        depth |= {each: above + number for number, each in enumerate(reversed(path), start=1)}
        if above + len(path) > MAX_DEPTH:
            deepest = next(each for each in reversed(path) if depth[each] > MAX_DEPTH)
            what, fix = f"more than {MAX_DEPTH} entities hang on each other", "hang some of them on the scene itself"
            return [scene.issue(f"{by_id[deepest].pointer}/parent", what, fix)]
    return []
