"""The viewer's window: it handles events, draws after changes, and watches the files."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from mimics_app.app.picture.overlay_keys import toggle_overlay
from mimics_app.app.picture.window_opening import open_window, remember_size
from mimics_app.app.settings import Profile
from mimics_app.app.terminal.output import say, with_line
from mimics_app.app.viewer.controls import ViewerControls
from mimics_app.app.viewer.editor import Editor
from mimics_app.app.viewer.page import KEYS, draw_caption, draw_hint, draw_message
from mimics_app.app.viewer.selection import Selection
from mimics_app.app.viewer.shown import Shown, Up, open_shown
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.clock import FRAME_NS, SECOND_NS, Clock, MonotonicClock
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.rendering.visual.figures.key_page import draw_keys
from mimics_app.rendering.visual.surfaces.headless import save_png
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.world.files.scene.watcher import SceneWatcher
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["ViewerSession"]

_POLL_NS = SECOND_NS // 4
"""Period of the checks of the files [ns]."""
_SHOW_NS = 5 * SECOND_NS
"""Time for which a message is shown [ns]."""
_REST_NS = SECOND_NS // 5
"""Time without a change after which a picture is drawn with anti-aliasing [ns]."""
_LONGEST_STEP_S = 0.1
"""Longest time step of the flight [s]."""


class ViewerSession:
    """One window, from opening to closing.

    Args:
        shown: The first model or scene.
        size: Size of the window [px]; None: see `open_window`.
        profile: Quality of a scene's picture.
        camera: See `Viewport`.
        up: Upward axis of a mesh file, for its reload.
        edit: Whether the panels of the editor are open from the start.

    Attributes:
        pictures: PNG files that the person saved.
        backend: Backend of the surface.
    """

    def __init__(
        self,
        shown: Shown,
        size: Size | None,
        profile: Profile = "training",
        camera: str = "",
        up: Up = "y",
        *,
        edit: bool = False,
    ) -> None:
        self._clock: Clock = MonotonicClock()
        self._up = up
        self._surface = open_window(size, f"{shown.title} - mimics")
        self._viewport = Viewport(self._surface, shown, profile, camera)
        self._selection = Selection(shown)
        self._editor = None if shown.scene is None else Editor(self._viewport, self._selection, self._say)
        self._controls = ViewerControls(self._viewport, self._selection, self._commands(), self._moved)
        self._watcher = SceneWatcher(shown.files)
        if edit and self._editor is not None:
            self._editor.open = self._editor.edited.stale = True
            self._editor.focus = "list"
        self._keys_shown = self._left = self._alarm = self._marked = self._warned = False
        self._message, self._message_until_ns = "", 0
        self._clip = ""
        self.pictures: list[Path] = []
        self.backend = self._surface.backend

    @property
    def saved(self) -> list[Path]:
        """Scene files that were written."""
        return [] if self._editor is None else self._editor.saved

    def run(self, shown: Callable[[], None] | None = None) -> None:
        """Run until the window closes; `shown` is called after the first picture."""
        self._draw(smooth=False)
        if shown is not None:
            shown()
        due = looked = before = begun = drawn = self._clock.now_ns()
        rested = False
        while not (self._surface.should_close or self._left):
            now = self._clock.now_ns()
            events = self._surface.poll()
            toggle_overlay(self._viewport.renderer, events)
            self._handle(events)
            if self._editor is None or self._editor.focus == "picture":
                self._controls.fly(min((now - before) / SECOND_NS, _LONGEST_STEP_S))
            before = now
            self._pass_time((now - begun) / SECOND_NS)
            if now - looked >= _POLL_NS:
                looked = now
                self._check_files(now)
            if self._controls.dirty or self._viewport.renderer.shows("graph"):
                self._controls.dirty, drawn, rested = False, now, not self._viewport.pays_for_pixels
                self._draw(smooth=rested)
            elif not rested and now - drawn > _REST_NS:
                rested = True
                self._draw(smooth=True)
            due = max(due + FRAME_NS, self._clock.now_ns() - FRAME_NS)
            self._clock.sleep_until_ns(due)

    def __enter__(self) -> ViewerSession:
        return self

    def __exit__(self, *exception: object) -> None:
        if self._editor is not None:
            self._editor.close()
            for what in self._editor.not_saved:
                say(f"not saved: {what}")
        self._viewport.release()
        remember_size(self._surface)
        self._surface.close()

    def _draw(self, *, smooth: bool) -> None:
        """Draw a frame, with anti-aliasing or, while a picture drawn on the processor changes, without."""
        shown, hud = self._viewport.shown, self._viewport.renderer.hud
        shown.world.update()
        hud.clear()
        self._mark_chosen()
        if self._editor is None or not self._editor.open:
            lines = [shown.size]
            if self._selection.chosen is not None:
                lines.append(self._describe_chosen())
            draw_caption(hud, shown.title, lines, shown.notes)
            draw_hint(hud, "H: keys" if self._editor is None else "H: keys   Tab: edit")
        if self._editor is not None:
            self._editor.draw()
        draw_message(hud, self._message, alarm=self._alarm)
        if self._keys_shown:
            draw_keys(hud, KEYS)
        self._viewport.draw(smooth=smooth)
        self._surface.swap()

    def _pass_time(self, seconds: float) -> None:
        """Advance effects and animations; a scene without them is drawn only after other changes."""
        effects, motion = self._viewport.shown.world.effects, self._viewport.shown.world.motion
        effects.time = motion.time = seconds
        self._controls.dirty = self._controls.dirty or bool(effects.emitters) or motion.alive

    def _mark_chosen(self) -> None:
        """Draw a box and arrows at the selected node; the overlay is created at the first selection."""
        if self._selection.chosen is not None:
            self._marked = True
            overlay = self._viewport.renderer.overlay
            overlay.chosen = self._selection.chosen.index
            overlay.handles = self._selection.handles(self._viewport.orbit.view(self._surface.size))
        elif self._marked:
            self._viewport.renderer.overlay.chosen = None

    def _describe_chosen(self) -> str:
        node = self._selection.chosen
        assert node is not None
        x, y, z = node.world_matrix()[:3, 3]
        axis = "" if self._selection.axis is None else f", along {'xyz'[self._selection.axis]}"
        unsaved = ", not saved (Ctrl + S)" if self._editor is not None and self._editor.edited.texts.unsaved else ""
        return f"{node.name or 'a part'} at {x:.3f}, {y:.3f}, {z:.3f} m{axis}{unsaved}"

    def _commands(self) -> dict[str, Callable[[], object]]:
        return {
            "h": self._toggle_keys,
            "escape": self._leave,
            "g": self._toggle_floor,
            "l": self._toggle_lights,
            "f12": self._take_picture,
            "ctrl+s": lambda: self._say("models cannot be edited here; scene files can", alarm=True),
            "n": lambda: self._next_clip(1),
            "p": lambda: self._next_clip(-1),
            "space": self._hold,
        }

    def _next_clip(self, step: int) -> None:
        """Play the next or the previous clip of the model; between the last and the first it is at rest."""
        from mimics_app.app.viewer.playing import clips_of, play_clip

        names = ["", *clips_of(self._viewport.shown)]
        if len(names) == 1:
            self._say("nothing moves in it")
            return
        self._clip = names[(names.index(self._clip) + step) % len(names)] if self._clip in names else names[1]
        play_clip(self._viewport.shown, self._clip)
        self._say(f'clip "{self._clip}"' if self._clip else "at rest")

    def _hold(self) -> None:
        """Hold the present clip, or let it continue."""
        layers = [
            layer for animator in self._viewport.shown.world.motion.animators.values() for layer in animator.layers
        ]
        held = any(layer.speed != 0.0 for layer in layers)
        for layer in layers:
            layer.speed = 0.0 if held else 1.0
        if layers:
            self._say("paused" if held else "playing")

    def _toggle_keys(self) -> None:
        self._keys_shown = not self._keys_shown

    def _toggle_floor(self) -> None:
        if self._viewport.studio is not None:
            self._viewport.studio.toggle_floor()

    def _toggle_lights(self) -> None:
        studio = self._viewport.studio
        if studio is None or not studio.has_own_lights:
            self._say("it has no lights of its own" if studio is not None else "the scene has its own light")
        else:
            studio.toggle_lights()

    def _leave(self) -> None:
        """Close the page of keys, else deselect, else close the window, after a warning about unsaved moves."""
        if self._keys_shown:
            self._keys_shown = False
        elif self._editor is None and self._selection.chosen is not None:
            self._selection.chosen = None
        elif self._editor is not None and self._editor.not_saved and not self._warned:
            self._warned = True
            self._say(f"not saved: {self._editor.not_saved[-1]}; Ctrl + S saves, Esc leaves", alarm=True)
        else:
            self._left = True

    def _take_picture(self) -> None:
        """Save the window's picture, with anti-aliasing and without a message."""
        self._message = ""
        self._draw(smooth=True)
        number = 1
        while (file := Path(f"{self._viewport.shown.path.stem}_{number:03d}.png")).exists():
            number += 1
        save_png(self._surface, file)
        self.pictures.append(file)
        self._say(f"picture: {file}")

    def _handle(self, events: Sequence[InputEvent]) -> None:
        """Give events to the editor first, where there is one, and what is not for it to the picture."""
        if self._editor is None:
            self._controls.handle(events)
            return
        for event in events:
            if self._keys_shown or not self._editor.handle(event):
                self._follow_edits()
                self._controls.handle([event])
            elif event.kind != "move":
                self._controls.dirty, self._warned = True, False
        self._follow_edits()

    def _follow_edits(self) -> None:
        assert self._editor is not None
        if self._editor.follow():
            self._controls.dirty = True
            self._watcher.watch(self._viewport.shown.files)

    def _moved(self, node: SceneNode) -> None:
        if self._editor is not None:
            self._warned = False
            self._editor.moved(node.name)

    def _check_files(self, now_ns: int) -> None:
        """Remove an old message, and reload changed files."""
        if self._message and now_ns > self._message_until_ns:
            self._message, self._controls.dirty = "", True
        renderer = self._viewport.renderer
        before = renderer.shaders_replaced
        for issue in renderer.reload_shaders():
            say(str(issue))
            self._say(str(issue), alarm=True)
        self._controls.dirty = self._controls.dirty or renderer.shaders_replaced != before
        if self._selection.holding or not self._watcher.changed():
            return
        try:
            self._take_over()
        except MimicsError as error:
            self._say(with_line(error.issues[0]), alarm=True)
            self._message_until_ns = sys.maxsize  # until the file is corrected

    def _take_over(self) -> None:
        """Show the present contents of the files; where one is faulty, the old picture stays."""
        shown = self._viewport.shown
        if self._editor is not None:
            self._editor.take_files()
        else:
            fresh = open_shown(shown.path, self._up)
            self._viewport.show(fresh)
            self._selection.show(fresh)
            self._say("loaded again")
        self._watcher.watch(self._viewport.shown.files)

    def _say(self, text: str, *, alarm: bool = False) -> None:
        self._message, self._alarm = text, alarm
        self._message_until_ns = self._clock.now_ns() + _SHOW_NS
        self._controls.dirty = True
