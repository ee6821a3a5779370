"""What a mirror shows: a window, or a picture in a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Self

import numpy as np

from mimics_app.app.mirror.mirror_buffer import MirrorBuffer
from mimics_app.app.mirror.mirror_link import MirrorLink
from mimics_app.app.picture.active_view import view_names
from mimics_app.app.picture.picture import Picture, live_quality
from mimics_app.app.picture.shown_on import open_display
from mimics_app.app.picture.window_opening import open_window
from mimics_app.app.planner.plan import apply_plan
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.person_edit import edit_of_plain
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.contracts.clock import FRAME_NS, SECOND_NS, Clock, MonotonicClock
from mimics_app.contracts.errors import DeviceError, Issue, SceneError
from mimics_app.contracts.messages.mirror_frame import MirrorFrame
from mimics_app.recording.report_values import mapping
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.world.content.effects import Burst
from mimics_app.world.files.scene.file import build_world

__all__ = ["MirrorDisplay", "MirroredScene"]

_PATIENCE_NS = 60 * SECOND_NS
"""Longest wait for a session [ns]."""
_OFFSCREEN: Size = (1280, 720)
_SOUND_NS = SECOND_NS
"""Time for which the name of a sound is shown [ns]."""


class MirroredScene:
    """A world as the session has built it.

    Args:
        name: Name of the scene, or its file.
        wanted: Hash of the session's scene.
        edit: Change of the scene for the person who plays, as plain JSON; None: none.

    Raises:
        SceneError: It is not here, or another one than the session's.
    """

    def __init__(self, name: str, wanted: str, edit: Mapping[str, object] | None = None) -> None:
        self.scene = load_checked_scene(find_scene(Path(name)), edit=edit_of_plain(edit or {}))
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
            raise SceneError(Issue(self.scene.file, "", f"does not fit the session: {error}", "restart it")) from error
        for row in rows[table.visible[rows] != frame.visible]:
            table.set_visible(int(table.entities[row]), visible=not table.visible[row])
        self._show_cords(frame)
        self._show_effects(frame)
        self.world.update()

    def _show_cords(self, frame: MirrorFrame) -> None:
        for note in frame.cords:
            if (cord := self.world.cords.get(note.name)) is not None:
                cord.ends, cord.ball = np.array(note.ends), np.array(note.ball)
                cord.length, cord.radius, cord.colour = note.length, note.radius, note.colour
                cord.visible, cord.swing, cord.taps = note.visible, note.swing, list(note.taps)

    def _show_effects(self, frame: MirrorFrame) -> None:
        effects = self.world.effects
        effects.time, effects.seed = frame.effects.time_s, frame.effects.seed
        effects.bursts = [
            Burst(note.emitter, note.number, note.born_s, np.array(note.world_from_emitter).reshape(4, 4))
            for note in frame.effects.bursts
            if note.emitter in effects.emitters
        ]


class MirrorDisplay:
    """Shows the session of a connection, once there is one.

    Args:
        link: The connection.
        buffer: Its frames.
        scene: Scene file; "": that of the session's name.
        camera: View that is shown first; "": as the scene says.
        output: File for the last picture, without a window; None: a window.
        size: Size of the picture [px]; None: as suits it.

    Attributes:
        scene: Name of the scene.

    Raises:
        DeviceError: No session begins within a minute, it is not for viewers, or there is no display.
        SceneError: The scene is not here, or another one.
    """

    def __init__(
        self, link: MirrorLink, buffer: MirrorBuffer, scene: str, camera: str, output: Path | None, size: Size | None
    ) -> None:
        self._clock: Clock = MonotonicClock()
        self._link, self._buffer, self._output = link, buffer, output
        card = self._wait_for_session()
        if card["edit"] is None:
            what = "the scene of the session is changed for its person, which an address for viewing is not told"
            raise DeviceError(what, "give the address of the operator's page: this display takes nobody's place")
        self._shown = MirroredScene(scene or str(card["scene"]), str(card["scene_hash"]), mapping(card["edit"]))
        self.scene = self._shown.scene.name
        title = f"{self._shown.scene.title or self.scene} - mimics mirror"
        surface = open_window(size, title) if output is None else open_offscreen("auto", size or _OFFSCREEN)
        display = open_display(self._shown.scene, "desktop", surface)
        quality = live_quality(self._shown.scene, "training", surface)
        self._picture = Picture(surface, self._shown.scene, self._shown.world, quality, camera, display)
        self._sound, self._sound_until_ns = "", 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._picture.close()

    def run(self, seconds: float | None) -> int:
        """Show the session for a time [s], None: until the window is closed; return the number of pictures."""
        begun = due = self._clock.now_ns()
        count, left = 0, False
        while not (self._picture.surface.should_close or left):
            now_ns = self._clock.now_ns()
            if seconds is not None and now_ns - begun > seconds * SECOND_NS:
                break
            left = self._handle()
            count += self._draw(now_ns)
            due = max(due + FRAME_NS, self._clock.now_ns() - FRAME_NS)
            self._clock.sleep_until_ns(due)
        if self._output is not None:
            self._picture.save(self._output)
        return count

    def _wait_for_session(self) -> dict[str, object]:
        until = self._clock.now_ns() + _PATIENCE_NS
        while (card := self._link.card) is None:
            if self._clock.now_ns() > until:
                raise DeviceError(f"the display shows no session: {self._link.why}", "start it with --console")
            self._clock.sleep_until_ns(self._clock.now_ns() + FRAME_NS)
        return card

    def _draw(self, now_ns: int) -> bool:
        """Draw the state that is due; return whether there is one."""
        frame = self._buffer.at(now_ns)
        if frame is None:
            return False
        self._shown.show(frame)
        if sounds := self._buffer.take_sounds(frame):
            self._sound, self._sound_until_ns = sounds[-1].name, now_ns + _SOUND_NS
        why = "" if self._link.card is not None else self._link.why
        sound = f"sound: {self._sound}" if now_ns < self._sound_until_ns else ""
        self._picture.draw(frame.board.saying(why or sound), now_ns)
        self._picture.surface.swap()
        return True

    def _handle(self) -> bool:
        """Take the keys of the window; return whether the person leaves."""
        views = view_names(self._shown.world)
        for event in self._picture.surface.poll():
            if event.kind != "key" or not event.pressed:
                continue
            if event.name == "escape":
                return True
            if event.name == "v":
                self._picture.show_view(views[(views.index(self._picture.view.name) + 1) % len(views)])
            elif event.name.isdigit() and 0 < int(event.name) <= len(views):
                self._picture.show_view(views[int(event.name) - 1])
        return False
