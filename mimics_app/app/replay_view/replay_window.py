"""Window in which recorded runs are looked at: time bar, speed, single frames, views, forces."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mimics_app.app.picture.overlay_keys import toggle_overlay
from mimics_app.app.picture.picture import live_quality
from mimics_app.app.picture.window_opening import open_window, remember_size
from mimics_app.app.replay_view.event_marks import marks_of
from mimics_app.app.replay_view.pane import Panes
from mimics_app.app.replay_view.playhead import Playhead
from mimics_app.app.replay_view.replay_sound import ReplaySound
from mimics_app.app.replay_view.replayed_scene import ReplayedScene
from mimics_app.app.replay_view.time_bar import HEIGHT, TimeBar
from mimics_app.contracts.clock import FRAME_NS, SECOND_NS, Clock, MonotonicClock
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.rendering.visual.figures.key_page import draw_keys
from mimics_app.rendering.visual.figures.palette import FAINT
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

__all__ = ["KEYS", "ReplayWindow"]

KEYS: tuple[tuple[str, str], ...] = (
    ("Space", "play or pause"),
    ("Left, right", "one frame back, one frame on"),
    ("Page up, page down", "ten seconds back, ten seconds on"),
    ("Home, end", "first frame, last frame"),
    ("+ and -", "faster and slower, 0.1x to 8x"),
    ("Click or drag on the bar", "that time"),
    ("1 to 9, V", "the views of the scene; the next one"),
    ("Right drag, wheel", "a camera of your own around the hand; a view ends it"),
    ("F5", "forces and contacts"),
    ("F11", "full screen"),
    ("H   Esc", "this page;  leave"),
)
"""Keys and their functions, in the order of the page."""

_LEAP_NS = 10 * SECOND_NS
_LONGEST_NS = 2 * FRAME_NS
"""Longest time for which frames are computed before the window is looked at again [ns]."""
_PATIENCE_NS = SECOND_NS // 4
"""Time between pictures while the way to another time is computed [ns]."""
_MOST_FRAMES = 6
"""Frames to the one that is shown, beyond which the way there is not played."""
_FASTER, _SLOWER = ("equal", "kp_add", "plus"), ("minus", "kp_subtract")


class ReplayWindow:
    """One window, from opening to closing.

    Args:
        runs: The runs, one or two; the bar is that of the first, and both show the same time from their first frame on.
        size: Size of the window [px]; None: see `open_window`.
        camera: See `Panes`.
        forces: See `Panes`.
        speed: The first speed, one of `playhead.SPEEDS`.
        sound: Whether the sounds of the first run are played, while it plays at the speed of the session.
    """

    def __init__(
        self,
        runs: Sequence[ReplayedScene],
        size: Size | None,
        camera: str = "",
        *,
        forces: bool,
        speed: float = 1.0,
        sound: bool = True,
    ) -> None:
        first = runs[0]
        self._clock: Clock = MonotonicClock()
        self._runs = runs
        self._surface = open_window(size, f"{first.run.folder.name} - mimics replay")
        self._panes = Panes(self._surface, runs, _quality_of, camera, forces=forces)
        self._page = PageSurface(self._surface)
        self._sound = ReplaySound(first, self._clock) if sound else None
        if self._sound is not None:
            self._sound.set_audible(on=False)
            first.listener = self._sound.step
        length_ns = max(int(run.times_ns[-1]) for run in runs)
        self._head = Playhead(length_ns, speed)
        self._bar = TimeBar(marks_of(first.run, first.begun_ns), length_ns)
        self._commands = self._make_commands()
        self._keys_shown = self._left = self._dragged = False
        self._held_at: tuple[float, float] | None = None
        self._dirty = True

    def run(self) -> None:
        """Run until the window closes."""
        due = before = drawn = self._clock.now_ns()
        there = True
        while not (self._surface.should_close or self._left):
            now = self._clock.now_ns()
            self._handle(self._surface.poll())
            if there and self._head.playing:
                self._head.advance(now - before)
                self._dirty = True
            before = now
            there = self._compute()
            now = self._clock.now_ns()
            if self._dirty and (there or now - drawn > _PATIENCE_NS):
                self._dirty, drawn = False, now
                self._draw(now, there=there)
            due = max(due + FRAME_NS, self._clock.now_ns() - FRAME_NS)
            self._clock.sleep_until_ns(due)

    def __enter__(self) -> ReplayWindow:
        return self

    def __exit__(self, *_: object) -> None:
        if self._sound is not None:
            self._sound.close()
        remember_size(self._surface)
        self._page.release()
        self._panes.close()

    def _compute(self) -> bool:
        """Bring the runs nearer to the time that is shown, and return whether they are there."""
        numbers = [run.number_at(self._head.time_ns) for run in self._runs]
        changed = any(run.number != number for run, number in zip(self._runs, numbers, strict=True))
        self._dirty = self._dirty or changed
        if self._sound is not None:
            follows = 0 <= numbers[0] - self._runs[0].number <= _MOST_FRAMES
            self._sound.set_audible(on=follows and self._head.playing and self._head.speed == 1.0)
        return all([run.to(number, _LONGEST_NS) for run, number in zip(self._runs, numbers, strict=True)])

    def _draw(self, now_ns: int, *, there: bool) -> None:
        """Draw the pictures, and the bar over them."""
        self._panes.draw(now_ns)
        page, first = self._page, self._runs[0]
        page.fit()
        page.hud.clear()
        view = "your camera" if self._panes.is_free else self._panes.view
        words = f"{view}, frame {first.number} of {first.count}" if there else "on the way there ..."
        self._bar.draw(page.hud, self._head, words)
        page.hud.text(page.hud.width - 18.0, HEIGHT + 8.0, "H: keys", 13.0, FAINT, align="right")
        if self._keys_shown:
            draw_keys(page.hud, KEYS)
        page.draw(over=True)
        self._surface.swap()

    def _handle(self, events: Sequence[InputEvent]) -> None:
        """Do what the person asks for."""
        for picture in self._panes.pictures:
            toggle_overlay(picture.renderer, events)
        for event in events:
            if event.kind == "key" and event.pressed:
                self._dirty = True
                self._press(event.name)
            elif event.kind == "button" and event.name == "left":
                self._dragged = event.pressed and self._seek(event)
            elif event.kind == "button" and event.name == "right":
                self._held_at = (event.x, event.y) if event.pressed else None
            elif event.kind == "move" and self._held_at is not None:
                self._orbit(event)
            elif event.kind == "wheel":
                self._panes.zoom(event.y)
                self._dirty = True
            elif event.kind == "move" and self._dragged:
                self._seek(event)
            elif event.kind == "resize":
                self._dirty = True

    def _press(self, key: str) -> None:
        views = self._panes.views
        if key in self._commands:
            self._commands[key]()
        elif key.isdigit() and 0 < int(key) <= len(views):
            self._panes.show_view(views[int(key) - 1])
        elif key == "v" and views:
            number = views.index(self._panes.view) + 1 if self._panes.view in views else 0
            self._panes.show_view(views[number % len(views)])

    def _seek(self, event: InputEvent) -> bool:
        """Show the time at the pointer; return whether it is on the bar, or was dragged from there."""
        x, y = self._page.place(event)
        time_ns = self._bar.time_at(self._page.hud, (x, 0.0 if self._dragged else y))
        if time_ns is not None:
            self._head.seek(time_ns)
            self._dirty = True
        return time_ns is not None

    def _orbit(self, event: InputEvent) -> None:
        """Turn the free camera by the way of the pointer since the last event."""
        assert self._held_at is not None
        width, height = self._surface.size
        right, up = 0.5 * (event.x - self._held_at[0]) * width, 0.5 * (event.y - self._held_at[1]) * height
        self._held_at = (event.x, event.y)
        self._panes.orbit(right, up)
        self._dirty = True

    def _step(self, frames: int) -> None:
        """Hold, and show a number of frames later; fewer than 0: earlier."""
        first = self._runs[0]
        number = min(max(1, first.number_at(self._head.time_ns) + frames), first.count)
        self._head.playing = False
        self._head.seek(int(first.times_ns[number - 1]))

    def _leap(self, time_ns: int) -> None:
        self._head.seek(self._head.time_ns + time_ns)

    def _make_commands(self) -> dict[str, Callable[[], object]]:
        """Return the function of each key."""
        head = self._head
        return {
            "space": head.toggle,
            "left": lambda: self._step(-1),
            "right": lambda: self._step(1),
            "page_up": lambda: self._leap(-_LEAP_NS),
            "page_down": lambda: self._leap(_LEAP_NS),
            "home": lambda: head.seek(0),
            "end": lambda: head.seek(head.length_ns),
            **dict.fromkeys(_FASTER, lambda: head.change_speed(1)),
            **dict.fromkeys(_SLOWER, lambda: head.change_speed(-1)),
            "h": self._toggle_keys,
            "escape": self._leave,
        }

    def _toggle_keys(self) -> None:
        self._keys_shown = not self._keys_shown

    def _leave(self) -> None:
        """Close the page of keys, else the window."""
        self._keys_shown, self._left = False, not self._keys_shown


def _quality_of(replayed: ReplayedScene, surface: Surface) -> RenderSettings:
    return live_quality(replayed.scene, replayed.profile, surface)
