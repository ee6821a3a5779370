"""What a check of the conformance kit comes to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Failed", "Finding", "NotApplicable", "must"]

Verdict = Literal["passed", "failed", "not applicable"]


@dataclass(frozen=True, slots=True)
class Finding:
    """What one check came to.

    Attributes:
        check: Its name.
        verdict: How it ended.
        what: What was found, where it failed or does not apply.
    """

    check: str
    verdict: Verdict
    what: str = ""


class Failed(Exception):
    """The device does not do what it must."""


class NotApplicable(Exception):
    """This cannot be asked of this device."""


def must(right: bool, what: str) -> None:
    """Refuse a device.

    Raises:
        Failed: It is not right.
    """
    if not right:
        raise Failed(what)
