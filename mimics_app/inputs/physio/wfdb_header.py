"""Check of a WFDB header: how much it claims, and that the files it names are beside it."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.read_budget import afford
from mimics_app.contracts.system.regular_file import open_regular, read_regular

__all__ = ["check_wfdb_header"]

_LONGEST = 1 << 20
_MOST_NESTED = 2
"""Headers within headers: a record of segments, and each of these."""


def check_wfdb_header(path: Path, depth: int = 1) -> None:
    """Check a header before the library follows it.

    Raises:
        SceneError: It cannot be read, claims more than is read at once, or names a file that is not in its folder.
    """
    try:
        text = read_regular(path, _LONGEST).decode("latin-1")
    except OSError as error:
        raise SceneError(Issue(str(path), "", f"cannot be read: {error.strerror}")) from error
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines or len(lines[0]) < 2:
        raise SceneError(Issue(str(path), "", "not a WFDB header"))
    name, signals, *rest = lines[0]
    try:
        samples = int(rest[1]) if len(rest) > 1 else 0
        afford(str(path), "", 8 * max(int(signals), 1) * max(samples, 0), "cut the record")
    except ValueError:
        raise SceneError(Issue(str(path), "", "states no numbers of signals and samples")) from None
    for words in lines[1:]:
        if "/" in name and words[0] != "~":
            _check_segment(path, words[0], depth)
        elif "/" not in name:
            _check_beside(path, words[0])


def _check_segment(path: Path, segment: str, depth: int) -> None:
    _check_beside(path, f"{segment}.hea")
    if depth >= _MOST_NESTED:
        raise SceneError(Issue(str(path), "", "is a record of records of segments"))
    check_wfdb_header(path.with_name(f"{segment}.hea"), depth + 1)


def _check_beside(path: Path, name: str) -> None:
    if Path(name).name != name or name in (".", ".."):
        raise SceneError(Issue(str(path), "", f'"{name}" is not in its folder', "copy the files into one folder"))
    try:
        open_regular(path.with_name(name)).close()
    except OSError as error:
        raise SceneError(Issue(str(path), "", f'"{name}" cannot be read: {error.strerror}')) from error
