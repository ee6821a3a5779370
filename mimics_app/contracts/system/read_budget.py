"""What one file may cost to read: the budget of every reader, asked of its header, before its data.

A file that claims more is refused; whatever is long by its nature (a recording, a film) is read in parts.
"""

from __future__ import annotations

from mimics_app.contracts.errors import Issue, SceneError

__all__ = ["READ_BUDGET", "afford", "over_budget"]

READ_BUDGET = 256 << 20
"""Memory that the data of one file may take [bytes]; with its working copies a reader stays within twice of it."""


def over_budget(size: int) -> str:
    """Return in words that data of a size [bytes] are too large; "" if they are not."""
    if size <= READ_BUDGET:
        return ""
    return (
        f"would take {size / (1 << 20):.0f} MB of memory, and {READ_BUDGET >> 20} MB is the most that is read at once"
    )


def afford(file: str, pointer: str, size: int, fix: str) -> None:
    """Refuse data of a file that would take more than the budget.

    Args:
        file: The file, for the message.
        pointer: Place in the file, or "".
        size: Memory of the data as they will be held [bytes].
        fix: What to do.

    Raises:
        SceneError: It is too large.
    """
    if what := over_budget(size):
        raise SceneError(Issue(file, pointer, what, fix))
