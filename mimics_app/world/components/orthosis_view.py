"""Component type of a drawn gait orthosis: marks that move with the belt, lamps on the leg that is free."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["OrthosisView"]

_Entities = tuple[str, ...]
_End = Annotated[float, Meta(ge=-5, le=5)]


@component("orthosis_view", limit=1, once=True)
class OrthosisView(Component, frozen=True):
    """What of a gait orthosis moves and shines in the picture by the state of the loop."""

    marks: Annotated[
        _Entities, Meta(max_length=40, description="Entities that lie on the belt, where they are before it moves")
    ] = ()
    belt: Annotated[
        tuple[_End, _End], Meta(description="Ends of the belt along z of the marks' parent, which it runs down [m]")
    ] = (-1.0, 1.0)
    left_lamps: Annotated[_Entities, Meta(max_length=8, description="Lamps on the left leg")] = ()
    right_lamps: Annotated[_Entities, Meta(max_length=8, description="Lamps on the right leg")] = ()
    lit: Annotated[str | None, Meta(description="Material of a lamp whose leg is free")] = None
    dark: Annotated[str | None, Meta(description="Material of a lamp otherwise")] = None


def _check(view: OrthosisView, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = [
        issue
        for field in ("marks", "left_lamps", "right_lamps")
        for number, name in enumerate(getattr(view, field))
        for issue in scene.check_entity(f"{pointer}/{field}/{number}", name)
    ]
    for field in ("lit", "dark"):
        name = getattr(view, field)
        issues += scene.check_material(f"{pointer}/{field}", name)
        if name is None and (view.left_lamps or view.right_lamps):
            issues.append(scene.issue(f"{pointer}/{field}", "is missing", "lamps need two materials"))
    if not view.belt[0] < view.belt[1]:
        issues.append(scene.issue(f"{pointer}/belt", "the first end is not behind the second", "exchange them"))
    return issues


register_check("orthosis_view", _check)
