"""Findings of the conformance kit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Failed", "Finding", "NotApplicable", "must"]

Verdict = Literal["passed", "failed", "not applicable"]


@dataclass(frozen=True, slots=True)
class Finding:
    """Result of one check.

    Attributes:
        check: Name of the check.
        verdict: Outcome.
        what: Reason, where it failed or does not apply.
    """

    check: str
    verdict: Verdict
    what: str = ""


class Failed(Exception):
    """The device violates a requirement."""


class NotApplicable(Exception):
    """The check does not apply to this device."""


def must(right: bool, what: str) -> None:
    """Fail the check unless `right`.

    Raises:
        Failed: `right` is False.
    """
    if not right:
        raise Failed(what)
