"""Pages over the picture of a session: what is to be done and with which keys, and the keys of the operator."""

from __future__ import annotations

from pathlib import Path

from mimics_app.app.session.mover import Mover
from mimics_app.rendering.visual.figures.key_page import KeyPage, Keys

__all__ = ["OPERATORS_PAGE", "session_keys", "task_page"]

_ALWAYS: Keys = (
    ("Space, gamepad B", "stop the force at once"),
    ("R", "allow force again after a stop"),
    ("P, gamepad Start", "pause; once more: resume"),
    ("1 to 9", "the views of the scene, where it has several"),
    ("H", "this page; then the operator's keys"),
    ("Esc", "end the session"),
)
_OPERATORS: Keys = (
    ("F1", "frames per second, times, and lowered qualities"),
    ("F2", "wireframe"),
    ("F3", "bounds of what is drawn"),
    ("F4", "lights"),
    ("F5", "forces, contacts and stability"),
    ("F6", "shadow maps"),
    ("F11", "full screen"),
    ("F12", "keep a picture in the recording"),
)
OPERATORS_PAGE = KeyPage(_OPERATORS, "Keys of the operator", foot="H: resume")
"""Keys for who operates or develops a session."""


def session_keys(mover: Mover, limb: str = "hand") -> Keys:
    """Return the keys of a session, and their functions.

    Args:
        mover: Who moves the device.
        limb: Its point of contact, "hand" or e.g. "right foot".
    """
    moving: dict[Mover, Keys] = {
        "at the pointer": (
            ("Mouse, arrows, left stick", f"move the {limb}"),
            ("Wheel, left button, trigger", "close and open the hand"),
            ("Shift", "slower"),
        ),
        "at the robot": (("The robot", f"move it with the {limb}"),),
        "simulated": (("Nothing to hold", f"a simulated patient moves the {limb}"),),
    }
    return (*moving[mover], *_ALWAYS)


def task_page(title: str, words: str, mover: Mover, limb: str, picture: Path | None) -> KeyPage:
    """Return the page of what is to be done, without its foot."""
    return KeyPage(session_keys(mover, limb), title, words, picture=picture)
