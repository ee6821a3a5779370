"""Keys and gamepad as sources of commands; no other part of the program knows these keys."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Command, End, Pause, Reset, Resume, StartTrial, Stop, View, name_of
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.shared_memory.command_ring import Answer, CommandSender
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.system.phrases import phrase

__all__ = ["KeyCommands", "command_of_key"]

_STOP_KEY, _STOP_BUTTON = "space", "b"
_ASK_NS = 4_000_000_000
"""Time within which a second Escape ends a trial [ns]."""
_UNDER_WAY = (TrialState.READY, TrialState.TRAVEL)
_PAD = "pad_"
_STEPS = {"pad_left_bumper": -1, "pad_right_bumper": 1}
"""Buttons that show the view before and after the present one."""


def _pause_or_resume(view: TaskView) -> Command:
    return Resume() if view.paused else Pause()


def _read_help(view: TaskView) -> Command | None:
    """H opens a page over the picture, which is read while the clock stands."""
    return Pause() if view.state is TrialState.TRAVEL and not view.paused else None


def _begin(view: TaskView) -> Command | None:
    return StartTrial() if view.reading else None


_KEYS: dict[str, Callable[[TaskView], Command | None]] = {
    "space": lambda view: Stop(),
    "pad_b": lambda view: Stop(),
    "r": lambda view: Reset(),
    "p": _pause_or_resume,
    "pad_start": _pause_or_resume,
    "h": _read_help,
    "enter": _begin,
    "mouse_left": _begin,
    "pad_a": _begin,
    "escape": lambda view: End(),
}


def command_of_key(name: str, view: TaskView) -> Command | None:
    """Return the command of a key ("p"), mouse button ("mouse_left") or gamepad button ("pad_b"); None for none.

    Args:
        name: The key or button.
        view: State of the task that the person sees.
    """
    find = _KEYS.get(name)
    return None if find is None else find(view)


class KeyCommands:
    """Gives the commands of keys and buttons once a frame.

    Space and gamepad B request a stop as long as they are held. During a trial Escape must be pressed twice.

    Args:
        memory: Memory of the session.
        report: Shows a line to the person.
        views: Views of the scene, for the keys 1 to 9 and the gamepad's shoulder buttons where there are several.
        shown: Returns the name of the present view, "" for the first one.

    Attributes:
        message: Line for the person after Escape during a trial; "" otherwise.
    """

    def __init__(
        self,
        memory: SessionMemory,
        report: Callable[[str], None],
        views: Sequence[str] = (),
        shown: Callable[[], str] = str,
    ) -> None:
        self._keys = CommandSender(memory, CommandSource.KEYS, "keyboard")
        self._pad = CommandSender(memory, CommandSource.GAMEPAD, "gamepad")
        self._report = report
        self._views = (
            {str(number): View(name) for number, name in enumerate(views[:9], start=1)} if len(views) > 1 else {}
        )
        self._names, self._shown = list(views), shown
        self._space_held = False
        self._asked_ns: int | None = None
        self._waiting: dict[tuple[CommandSender, int], Command] = {}
        self.message = ""

    def step(self, window: WindowFrame, pressed: Sequence[str], view: TaskView, now_ns: int) -> None:
        """Give the commands of a frame, and report those of the last one that were refused.

        Args:
            window: Events and gamepad of the frame.
            pressed: Names of the keys and buttons that went down.
            view: State of the task that the person saw.
            now_ns: The session's time [ns].
        """
        self._tell_refusals()
        if self._asked_ns is not None and now_ns - self._asked_ns > _ASK_NS:
            self._asked_ns, self.message = None, ""
        for name in pressed:
            command = self._views.get(name) or self._next_view(name) or command_of_key(name, view)
            if command is not None and not (isinstance(command, End) and self._asks(view, now_ns)):
                self._give(self._pad if name.startswith(_PAD) else self._keys, command, now_ns)
        self._hold_stops(window)

    def _next_view(self, name: str) -> Command | None:
        """Return the command of a shoulder button of the gamepad, where there are several views."""
        if name not in _STEPS or len(self._names) < 2:
            return None
        present = self._names.index(self._shown()) if self._shown() in self._names else 0
        return View(self._names[(present + _STEPS[name]) % len(self._names)])

    def _asks(self, view: TaskView, now_ns: int) -> bool:
        """Whether this is the first Escape during a trial, after the page of the task, which asks for another."""
        if self._asked_ns is not None or view.reading or view.state not in _UNDER_WAY:
            return False
        self._asked_ns = now_ns
        self.message = phrase("Press Esc again to end: this trial will not count")
        return True

    def _give(self, sender: CommandSender, command: Command, now_ns: int) -> None:
        try:
            self._waiting[sender, sender.send(command, now_ns)] = command
        except UsageError as error:
            self._report(str(error))

    def _hold_stops(self, window: WindowFrame) -> None:
        """Keep a stop requested while its key is held; a button without a release event is held for no time."""
        for event in window.events:
            if event.kind == "key" and event.name == _STOP_KEY:
                self._space_held = event.pressed
        if self._space_held:
            self._keys.hold_stop()
        if _STOP_BUTTON in window.gamepad.buttons:
            self._pad.hold_stop()

    def _tell_refusals(self) -> None:
        for sender in (self._keys, self._pad):
            for answer in sender.answers():
                self._tell(self._waiting.pop((sender, answer.sequence), None), answer)

    def _tell(self, command: Command | None, answer: Answer) -> None:
        if command is not None and not answer.done:
            self._report(f"{name_of(command)} is refused: {answer.why}")
