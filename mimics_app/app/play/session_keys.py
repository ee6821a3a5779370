"""Pages over the picture of a session: what is to be done and with which keys, and the keys of the operator."""

from __future__ import annotations

from pathlib import Path

from mimics_app.app.session.mover import Mover
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.visual.figures.key_page import KeyPage, Keys

__all__ = ["OPERATORS_PAGE", "session_keys", "task_page"]

_ALWAYS: Keys = (
    (phrase("Space, gamepad B"), phrase("stop the force at once")),
    ("R", phrase("allow force again after a stop")),
    (phrase("P, gamepad Start"), phrase("pause; once more: resume")),
    (phrase("1 to 9, gamepad LB or RB"), phrase("the views of the scene, where it has several")),
    ("H", phrase("this page; then the operator's keys")),
    ("Esc", phrase("end the session")),
)
_OPERATORS: Keys = (
    ("F1", phrase("frames per second, times, and lowered qualities")),
    ("F2", phrase("wireframe")),
    ("F3", phrase("bounds of what is drawn")),
    ("F4", phrase("lights")),
    ("F5", phrase("forces, contacts and stability")),
    ("F6", phrase("shadow maps")),
    ("F11", phrase("full screen")),
    ("F12", phrase("keep a picture in the recording")),
)
OPERATORS_PAGE = KeyPage(_OPERATORS, phrase("Keys of the operator"), foot=phrase("H: resume"))
"""Keys for who operates or develops a session."""


def session_keys(mover: Mover, limb: str = "hand") -> Keys:
    """Return the keys of a session, and their functions.

    Args:
        mover: Who moves the device.
        limb: Its point of contact, "hand" or e.g. "right foot".
    """
    moving: dict[Mover, Keys] = {
        "at the pointer": (
            (phrase("Mouse, arrows, left stick"), phrase("move the {limb}", limb=limb)),
            (phrase("Wheel, left button, trigger"), phrase("close and open the hand")),
            (phrase("Shift"), phrase("slower")),
        ),
        "at the robot": ((phrase("The robot"), phrase("move it with the {limb}", limb=limb)),),
        "simulated": ((phrase("Nothing to hold"), phrase("a simulated patient moves the {limb}", limb=limb)),),
    }
    return (*moving[mover], *_ALWAYS)


def task_page(title: str, words: str, mover: Mover, limb: str, picture: Path | None) -> KeyPage:
    """Return the page of what is to be done, without its foot."""
    return KeyPage(session_keys(mover, limb), title, words, picture=picture)
