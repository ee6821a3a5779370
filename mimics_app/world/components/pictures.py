"""Component types that show a view of the scene itself: mirrors, screens, and insets over the display."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Share
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check
from mimics_app.world.components.shapes import PlaneShape, RingShape
from mimics_app.world.components.visible import CameraComponent, MeshComponent

__all__ = ["Inset", "Mirror", "Screen"]

Every = Annotated[int, Meta(ge=1, le=60, description="Rendered in one frame of this many")]
Side = Annotated[int, Meta(ge=16, le=4096)]


@component("mirror", limit=1000)
class Mirror(Component, frozen=True):
    """The entity's flat mesh is a mirror on the side its normals point to; beside `mesh`.

    In a mirror, and in the view of any other camera, other mirrors show the sky.
    """

    tint: Annotated[tuple[Share, Share, Share], Meta(description="Reflectance, linear RGB")] = (
        1.0,
        1.0,
        1.0,
    )
    resolution: Annotated[
        float, Meta(ge=0.1, le=1, description="Resolution of its texture over that of the display")
    ] = 1.0


@component("screen", limit=1000)
class Screen(Component, frozen=True):
    """The entity's mesh shows the view of a camera; beside `mesh`. A screen in its own view shows the previous one."""

    camera: Annotated[str, Meta(description="Id of an entity with a `camera`")]
    size: Annotated[tuple[Side, Side], Meta(description="Size of its texture [px]")] = (512, 288)
    every: Every = 1
    shows: Annotated[
        Literal["light", "paint"],
        Meta(description="light: emissive, as a monitor; paint: lit as the mesh's material is"),
    ] = "light"
    brightness: Annotated[float, Meta(gt=0, le=100, description="Factor on the view's radiance")] = 1.0


@component("inset", limit=1000)
class Inset(Component, frozen=True):
    """A rectangle over the display that shows the view of a second camera: picture in picture, rear view."""

    camera: Annotated[str, Meta(description="Id of an entity with a `camera`")]
    rectangle: Annotated[
        tuple[Share, Share, Share, Share],
        Meta(description="Left, bottom, width and height as shares of the display"),
    ] = (0.7, 0.7, 0.27, 0.27)
    mirrored: Annotated[bool, Meta(description="Left and right exchanged, as in a driver's mirror")] = False
    every: Every = 1
    border: Annotated[float, Meta(ge=0, le=50, description="Width of its border in a display of 720 lines [px]")] = 3.0


def _check_mirror(mirror: Mirror, pointer: str, scene: CheckedScene) -> list[Issue]:
    mesh = _mesh_beside(pointer, scene)
    if mesh is None:
        return [_needs_mesh(pointer, scene)]
    if mesh.primitive is not None and not isinstance(mesh.primitive, PlaneShape | RingShape):
        return [scene.issue(pointer, "a mirror is flat", 'give its mesh the shape "plane" or "ring"')]
    return []


def _check_screen(screen: Screen, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = [] if _mesh_beside(pointer, scene) else [_needs_mesh(pointer, scene)]
    if pointer.rpartition("/")[0] in {other.rpartition("/")[0] for _, _, other in scene.components(Mirror)}:
        issues.append(scene.issue(pointer, "a screen cannot be a mirror too", "keep one of the two"))
    return issues + scene.check_entity_with(CameraComponent, f"{pointer}/camera", screen.camera)


def _check_inset(inset: Inset, pointer: str, scene: CheckedScene) -> list[Issue]:
    left, bottom, width, height = inset.rectangle
    issues = scene.check_entity_with(CameraComponent, f"{pointer}/camera", inset.camera)
    if width == 0.0 or height == 0.0 or left + width > 1.0 + 1e-9 or bottom + height > 1.0 + 1e-9:
        what = f"{list(inset.rectangle)} is empty or reaches beyond the display"
        issues.append(scene.issue(f"{pointer}/rectangle", what, "left + width and bottom + height are 1 at most"))
    return issues


def _mesh_beside(pointer: str, scene: CheckedScene) -> MeshComponent | None:
    """Return the mesh of the entity whose component has this pointer."""
    beside = pointer.rpartition("/")[0]
    return next(
        (mesh for _, mesh, other in scene.components(MeshComponent) if other.rpartition("/")[0] == beside), None
    )


def _needs_mesh(pointer: str, scene: CheckedScene) -> Issue:
    return scene.issue(pointer, 'needs a "mesh" of the same entity to be seen on', 'give the entity a "mesh"')


register_check("mirror", _check_mirror)
register_check("screen", _check_screen)
register_check("inset", _check_inset)
