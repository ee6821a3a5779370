"""The closed vocabulary of commands, and which source may give which."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, get_args

import msgspec
from msgspec import Meta

from mimics_app.contracts.commands.command_records import CommandSource

__all__ = [
    "LONGEST_NAME",
    "LONGEST_TEXT",
    "AnyCommand",
    "Calibrate",
    "Command",
    "Confirm",
    "End",
    "Fault",
    "Mark",
    "Mute",
    "Note",
    "Obstacle",
    "Pause",
    "Policy",
    "Recalibrate",
    "Repeat",
    "Reply",
    "Reset",
    "Resume",
    "SetAssistance",
    "SetParameter",
    "Skip",
    "StartTrial",
    "Stop",
    "View",
    "Volume",
    "command_names",
    "command_values",
    "name_of",
    "read_command",
    "refusal",
    "write_command",
]

LONGEST_TEXT, LONGEST_NAME = 300, 80
"""Lengths of a text and of a name [characters]."""

Text = Annotated[str, Meta(min_length=1, max_length=LONGEST_TEXT)]
Name = Annotated[str, Meta(min_length=1, max_length=LONGEST_NAME)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
LOUDEST = 2.0
"""Largest volume, 1 as authored; also the largest that a calibration leads to."""
Level = Annotated[float, Meta(ge=0.0, le=LOUDEST)]


def _tag(name: str) -> str:
    """Return "set_parameter" for "SetParameter"."""
    return "".join(f"_{each.lower()}" if each.isupper() else each for each in name).lstrip("_")


class Command(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="command", tag=_tag):
    """One command; its name in files is that of its class: "set_parameter"."""


class Pause(Command, frozen=True):
    """Halt the task and its clock; the robot is held."""


class Resume(Command, frozen=True):
    """End a pause."""


class Stop(Command, frozen=True):
    """Take the force away within two ticks, latched until `Reset`."""


class Reset(Command, frozen=True):
    """Allow force again after a stop."""


class Skip(Command, frozen=True):
    """End the trial under way as aborted; the next one follows."""


class Repeat(Command, frozen=True):
    """End the trial under way, if any, as aborted, and play it, or the one before a rest, once more."""


class StartTrial(Command, frozen=True):
    """End the page of the task, a shown result, or a rest; the robot's way to the start stays as it is."""


class SetParameter(Command, frozen=True):
    """Set an adaptable parameter of the task, within the limits that a policy has, or one of the controller.

    Attributes:
        name: Name of the parameter; "controller.NAME" is one of the controller under which the person leads.
        value: New value, in the parameter's unit; beyond the limits it is the nearest allowed one.
    """

    name: Name
    value: float


class SetAssistance(Command, frozen=True):
    """Set the task's adaptable parameter "assistance".

    Attributes:
        share: 0: least help, 1: most, within the limits of the parameter.
    """

    share: Share


class Policy(Command, frozen=True):
    """Let the policy act, or not.

    Attributes:
        mode: "on": its choices are carried out; "off": it is not asked; "propose": each waits for `Confirm`.
    """

    mode: Literal["on", "off", "propose"]


class Confirm(Command, frozen=True):
    """Carry out what the policy proposed, or drop it."""

    accept: bool = True


class Obstacle(Command, frozen=True):
    """Let an obstacle of the scene appear, by name."""

    name: Name


class Fault(Command, frozen=True):
    """Inject a fault into a simulated device, by name."""

    name: Name


class Calibrate(Command, frozen=True):
    """Carry out a step of the device's calibration, by name, while the device is inactive."""

    step: Name


class Note(Command, frozen=True):
    """Write a line of text into the recording."""

    text: Text


class Mark(Command, frozen=True):
    """Write a marker into the recording, by name."""

    name: Name


class View(Command, frozen=True):
    """Switch to a view of the scene, by name."""

    name: Name


class Volume(Command, frozen=True):
    """Set the volume of all sound: 1 as authored, 0 silent, 2 at most."""

    level: Level


class Mute(Command, frozen=True):
    """Silence all sound, or end that."""

    on: bool = True


class Recalibrate(Command, frozen=True):
    """Measure the baseline of the body signals anew."""


class End(Command, frozen=True):
    """End the session."""


class Reply(NamedTuple):
    """What a receiver says of a command: whether it is carried out, and why not, or a remark."""

    done: bool
    why: str = ""


AnyCommand = (
    Pause | Resume | Stop | Reset | Skip | Repeat | StartTrial | SetParameter | SetAssistance | Policy | Confirm
    | Obstacle | Fault | Calibrate | Note | Mark | View | Volume | Mute | Recalibrate | End
)  # fmt: skip
"""Every command; the vocabulary is closed."""


_PRESENT = (CommandSource.KEYS, CommandSource.GAMEPAD, CommandSource.BUTTON, CommandSource.OPERATOR)
"""Sources with a person who sees the robot."""
_MOVES_A_PERSON = (Reset, StartTrial, SetAssistance)
_ONLY: dict[CommandSource, tuple[tuple[type[Command], ...], str]] = {
    CommandSource.LSL: ((Note, Mark, Stop), "LSL may give only note, mark and stop"),
    CommandSource.STOP_BUTTON: ((Stop,), "the operator's STOP may give only stop"),
    CommandSource.ATTENDANCE: ((Pause, Stop), "a lost operator leads only to pause and stop"),
}
"""What sources that may not give everything may give, and the refusal of all else."""


def refusal(command: Command, source: CommandSource, *, simulated: bool) -> str:
    """Return why a source may not give a command; "" where it may.

    Args:
        command: The command.
        source: Who gives it.
        simulated: Whether the device is a simulated one.
    """
    allowed, why = _ONLY.get(source, ((Command,), ""))
    if not isinstance(command, allowed):
        return why
    if isinstance(command, _MOVES_A_PERSON) and not simulated and source not in _PRESENT:
        return "on a real device this comes from a key, the gamepad, a device button or the operator only"
    if isinstance(command, Fault) and not simulated:
        return "faults are injected into simulated devices only"
    return ""


_DECODER = msgspec.json.Decoder(AnyCommand)
_ENCODER = msgspec.json.Encoder()


def command_names() -> tuple[str, ...]:
    """Return the names of all commands."""
    return tuple(_tag(kind.__name__) for kind in get_args(AnyCommand))


def name_of(command: Command) -> str:
    """Return the name of a command, as "set_parameter"."""
    return _tag(type(command).__name__)


def command_values(command: Command) -> dict[str, Any]:
    """Return the fields of a command by name."""
    return msgspec.structs.asdict(command)


def write_command(command: Command) -> bytes:
    """Return a command as JSON.

    Raises:
        ValueError: A value is outside what the command takes.
    """
    written = _ENCODER.encode(command)
    _DECODER.decode(written)
    return written


def read_command(written: bytes) -> AnyCommand:
    """Return the command of its JSON.

    Raises:
        ValueError: It is none.
    """
    try:
        return _DECODER.decode(written)
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error
