"""Commands that the buttons of a device give: the usual ones, or what the scene's robot says."""

from __future__ import annotations

import json
from collections.abc import Mapping

from mimics_app.contracts.commands.vocabulary import Command, read_command
from mimics_app.contracts.errors import require_choice
from mimics_app.contracts.loop.haptic import Button

__all__ = ["BUTTONS", "button_commands"]

BUTTONS: Mapping[str, tuple[Button, str]] = {"primary": (Button.PRIMARY, "start_trial")}
"""Bit of the buttons word and usual command of each button, by its name. The stop button is none of them: the loop
itself obeys it, in its tick."""


def button_commands(said: Mapping[str, str]) -> dict[int, Command]:
    """Return the command of each button by its bit.

    Args:
        said: Names of commands by names of buttons, of the scene's robot; "" takes a button's command away.

    Raises:
        UsageError: Devices have no button of a name.
    """
    for name in said:
        require_choice(name, BUTTONS, "button")
    wanted = {int(bit): said.get(name, usual) for name, (bit, usual) in BUTTONS.items()}
    return {bit: read_command(json.dumps({"command": name}).encode()) for bit, name in wanted.items() if name}
