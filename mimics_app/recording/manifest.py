"""manifest.json, the last file of a run: how the run ended, and the SHA-256 of the other files."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import msgspec

from mimics_app.contracts.system.regular_file import open_regular, read_regular
from mimics_app.recording.json_text import parse_object
from mimics_app.recording.run_folder import FILES, write_atomically

__all__ = ["Manifest", "Seal", "hash_files", "read_manifest", "write_manifest"]

_SEALED = ("haptic", "index", "columns", "parameters", "statics", "signals", "events", "trials", "session")


@dataclass(frozen=True, slots=True)
class Seal:
    """SHA-256 of a file, 64 hexadecimal digits, and its length in bytes."""

    sha256: str
    bytes: int


@dataclass(frozen=True, slots=True)
class Manifest:
    """The end of a run and the state of its files.

    Attributes:
        status: "clean" when the app closed it, "interrupted" when the app died and the recorder finished alone,
            "recovered" when `mimics record recover` sealed it.
        state_hash: State hash of the files, see `StateHash`.
        rows, events, trials, parameters: Number of samples, loop events, finished trials and parameter blocks stored.
        dropped: Number of samples, loop events and journal messages dropped.
        restarts: Number of times the recorder process was replaced.
        gaps: Gaps of the samples: dicts with `reason`, `rows` and, where known, `after_tick`.
        problem: Last problem of the disk, "" for none.
        summary: Summary by the app: the object of `mimics run --json`, and more.
        clock: Wall and monotonic time at the end.
        files: Seal of each file by its name.
        lost: Losses and damages found by `mimics record recover`, one sentence each.
        version: Version of this format.
    """

    status: Literal["clean", "interrupted", "recovered"]
    state_hash: str
    rows: int
    events: int
    trials: int
    parameters: int
    dropped: dict[str, int] = field(default_factory=dict)
    restarts: int = 0
    gaps: list[dict[str, Any]] = field(default_factory=list)
    problem: str = ""
    summary: dict[str, Any] = field(default_factory=dict)
    clock: dict[str, Any] = field(default_factory=dict)
    files: dict[str, Seal] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)
    version: int = 1


def hash_files(folder: Path) -> dict[str, Seal]:
    """Return the seals of the existing files that a manifest seals, by name."""
    sealed: dict[str, Seal] = {}
    trips = sorted(path.relative_to(folder).as_posix() for path in folder.glob("trips/*.arrows"))
    for name in (*(FILES[key] for key in _SEALED), *trips):
        try:
            with open_regular(folder / name) as file:
                digest = hashlib.file_digest(file, "sha256")
                sealed[name] = Seal(digest.hexdigest(), file.tell())
        except OSError:
            continue
    return sealed


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write manifest.json atomically."""
    write_atomically(folder / FILES["manifest"], msgspec.json.format(msgspec.json.encode(manifest), indent=1))


def read_manifest(folder: Path) -> tuple[Manifest | None, str]:
    """Return the manifest of a run and "", or None and the reason, "" where the run was never closed."""
    try:
        return msgspec.convert(parse_object(read_regular(folder / FILES["manifest"])), Manifest), ""
    except FileNotFoundError:
        return None, ""
    except OSError as error:
        return None, error.strerror or str(error)
    except (ValueError, RecursionError) as error:
        return None, str(error)
