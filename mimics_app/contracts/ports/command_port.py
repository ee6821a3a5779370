"""Port of programs of installed packages that give commands to a session: `mimics run --steer NAME`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, cast, runtime_checkable

from mimics_app.contracts.commands.vocabulary import Command
from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.loop.loop_fields import HapticSnapshot
from mimics_app.contracts.messages.trial_state import TaskView
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup, fault_of_builder, made_by

__all__ = ["PLUGINS", "Steersman", "open_steersman"]


@runtime_checkable
class Steersman(Protocol):
    """Gives commands, once a frame; made without arguments.

    They are those of a Python program: on a real device it may not give what moves a person.
    """

    def step(self, snapshot: HapticSnapshot, view: TaskView, now_ns: int) -> Sequence[Command]:
        """Return the commands of a frame.

        Args:
            snapshot: Newest state of the loop.
            view: State of the task that the person saw last.
            now_ns: The session's time [ns].
        """
        ...

    def refused(self, command: Command, why: str) -> None:
        """Take the refusal of a command of an earlier frame."""

    def close(self) -> None:
        """End; called once."""


PLUGINS = PluginGroup("mimics_app.command_sources", fault_of_builder(Steersman))
"""Sources of commands of installed packages."""


def open_steersman(name: str) -> Steersman:
    """Return the source of commands of an installed name.

    Raises:
        UsageError: No such source is installed, or it cannot be made.
    """
    if name not in PLUGINS.names():
        raise UsageError(f'there is no source of commands "{name}"', nearest(name, PLUGINS.names()))
    try:
        return cast("Steersman", made_by(cast("type", PLUGINS.load(name)), Steersman))
    except PluginError as error:
        raise UsageError(f'the source of commands "{name}" is not available: {error}') from error
