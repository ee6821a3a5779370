"""A program of an installed package as the source of commands of a session."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Command
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.loop_fields import HapticSnapshot
from mimics_app.contracts.messages.trial_state import TaskView
from mimics_app.contracts.ports.command_port import Steersman
from mimics_app.contracts.ports.plugins import raised
from mimics_app.contracts.shared_memory.command_ring import CommandSender
from mimics_app.contracts.shared_memory.session_memory import SessionMemory

__all__ = ["SteeredBy"]


class SteeredBy:
    """Passes on what a program gives; one that raises is not asked again, and the session continues.

    Args:
        memory: Memory of the session.
        steersman: The program; None: nobody steers.
        name: Its name.
        report: Shows a line to the person.
    """

    def __init__(
        self, memory: SessionMemory, steersman: Steersman | None, name: str, report: Callable[[str], None]
    ) -> None:
        self._steersman, self._report = steersman, report
        self._sender = None if steersman is None else CommandSender(memory, CommandSource.PYTHON, name)
        self._waiting: dict[int, Command] = {}

    def step(self, snapshot: HapticSnapshot, view: TaskView, now_ns: int) -> None:
        """Give the commands of a frame; arguments as of `Steersman.step`."""
        if self._steersman is None or self._sender is None:
            return
        try:
            for answer in self._sender.answers():
                command = self._waiting.pop(answer.sequence, None)
                if command is not None and not answer.done:
                    self._steersman.refused(command, answer.why)
            given = tuple(self._steersman.step(snapshot, view, now_ns))
        except Exception as error:  # noqa: BLE001  of a third party
            self._report(f"the source of commands {raised(error)}; it is not asked again")
            self.close()
            return
        for command in given:
            try:
                self._waiting[self._sender.send(command, now_ns)] = command
            except UsageError as error:
                self._report(str(error))

    def close(self) -> None:
        """End the program; a second call does nothing."""
        steersman, self._steersman = self._steersman, None
        if steersman is not None:
            steersman.close()
