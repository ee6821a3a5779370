"""Component type of a virtual person that follows the trials and encourages."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Name
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["Encourager"]

Clips = Annotated[tuple[Name, ...], Meta(min_length=1, max_length=20)]


@component("encourager", limit=100)
class Encourager(Component, frozen=True):
    """The model of the same entity reacts to trials with its clips; the haptic loop is not affected."""

    shown: Annotated[bool, Meta(description="False: the model is neither drawn nor animated")] = True
    idle: Annotated[Name, Meta(description="Clip between reactions")] = "idle"
    greet: Annotated[Name, Meta(description="Clip at the first trial of a session")] = "wave"
    praise: Annotated[Clips, Meta(description="Clips after a success, in turn")] = ("clap", "wave")
    cheer: Annotated[Name, Meta(description="Clip after a success that follows a failure or is the third in a row")] = (
        "cheer"
    )
    console: Annotated[Name, Meta(description="Clip after an unfinished trial")] = "beckon"
    farewell: Annotated[Name, Meta(description="Clip after the last trial")] = "wave"


def _check(wanted: Encourager, pointer: str, scene: CheckedScene) -> list[Issue]:
    model = scene.model_of(pointer)
    if model is None:
        return [scene.issue(pointer, "the entity shows no model that could react", 'give it a "mesh" with a "source"')]
    clips = [clip.name for clip in model.clips]
    named = {f"{pointer}/{name}": getattr(wanted, name) for name in ("idle", "greet", "cheer", "console", "farewell")}
    named |= {f"{pointer}/praise/{k}": clip for k, clip in enumerate(wanted.praise)}
    return scene.check_names(named, "the model has no clip", clips, "it has none")


register_check("encourager", _check)
