"""Buttons of the device as a source of commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Command, Stop, name_of
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.shared_memory.command_ring import CommandSender
from mimics_app.contracts.shared_memory.session_memory import SessionMemory

__all__ = ["DeviceButtons"]


class DeviceButtons:
    """Gives the command of each button once when it is pressed; one that stops does so as long as it is held.

    The stop bit of a device is none of these: the loop obeys it in its tick.

    Args:
        memory: Memory of the session.
        commands: Command by bit of the device's buttons word.
        report: Shows a line to the person.
    """

    def __init__(self, memory: SessionMemory, commands: Mapping[int, Command], report: Callable[[str], None]) -> None:
        self._sender = CommandSender(memory, CommandSource.BUTTON, "device")
        self._commands, self._report = commands, report
        self._held = 0
        self._waiting: dict[int, Command] = {}

    def step(self, buttons: int, now_ns: int) -> None:
        """Give the commands of the buttons that went down, and report those of the last frame that were refused.

        Args:
            buttons: The device's buttons word.
            now_ns: The session's time [ns].
        """
        for answer in self._sender.answers():
            command = self._waiting.pop(answer.sequence, None)
            if command is not None and not answer.done:
                self._report(f"{name_of(command)} by the device's button is refused: {answer.why}")
        pressed, self._held = buttons & ~self._held, buttons
        for bit, command in self._commands.items():
            if pressed & bit:
                self._give(command, now_ns)
            elif buttons & bit and isinstance(command, Stop):
                self._sender.hold_stop()

    def _give(self, command: Command, now_ns: int) -> None:
        try:
            self._waiting[self._sender.send(command, now_ns)] = command
        except UsageError as error:
            self._report(str(error))
