"""The scene of a session in a world of the mirror's own, moved by the frames that arrive."""

from __future__ import annotations

from pathlib import Path

from mimics_app.app.planner.plan import apply_plan
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.messages.mirror_frame import MirrorFrame
from mimics_app.world.files.scene.file import build_world

__all__ = ["MirroredScene"]


class MirroredScene:
    """A world as the session has built it.

    Args:
        name: Name of the scene, or its file.
        wanted: Hash of the session's scene.

    Raises:
        SceneError: It is not here, or another one than the session's.
    """

    def __init__(self, name: str, wanted: str) -> None:
        self.scene = load_checked_scene(find_scene(Path(name)))
        if self.scene.hash != wanted:
            what = "is another one than that of the session"
            raise SceneError(Issue(str(self.scene.path), "", what, "copy the files of the scene from that computer"))
        apply_plan(self.scene, "training")
        self.world = build_world(self.scene)
        open_scenario(self.scene, self.world)  # it makes nodes of its own, as it did there
        self.world.motion.hold()
        self.world.followers.clear()

    def show(self, frame: MirrorFrame) -> None:
        """Bring the world to a frame.

        Raises:
            SceneError: The frame has rows that this world has not.
        """
        table, rows = self.world.transforms, frame.rows
        try:
            table.set_poses(rows, frame.translations, frame.rotations)
            table.set_scales(rows, frame.scales)
        except ValueError as error:
            raise SceneError(
                Issue(self.scene.file, "", f"does not fit the session: {error}", "start it anew")
            ) from error
        for row in rows[table.visible[rows] != frame.visible]:
            table.set_visible(int(table.entities[row]), visible=not table.visible[row])
        self.world.update()
