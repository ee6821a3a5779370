"""Port of exporters of recordings: the built-in ones, and those of installed packages (`mimics_app.exporters`).

An exporter is an object with a line about it and one method: from a recording to files.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from shutil import rmtree
from typing import Protocol, cast, runtime_checkable

from mimics_app.contracts.errors import MimicsError, OutputError, UsageError, require_choice
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup, raised
from mimics_app.recording import exporters
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import PRIVATE_FOLDER

__all__ = ["PLUGINS", "Exporter", "export_run", "exporter_names", "find_exporter"]


@runtime_checkable
class Exporter(Protocol):
    """Writes a recording in another format.

    Attributes:
        about: What it writes, in a line.
    """

    about: str

    def open(self, run: Run, folder: Path) -> Iterable[Path]:
        """Write files.

        Args:
            run: The recording, whole or cut off; nothing in its folder may be changed.
            folder: Empty folder; all files lie in it.

        Returns:
            The files. The same recording gives the same bytes.

        Raises:
            OSError: A file cannot be written.
        """
        ...


def _fault_of(name: str, loaded: object) -> str:
    if name in _BUILT_IN:
        return "has the name of a built-in exporter"
    return "" if isinstance(loaded, Exporter) else f"lacks open or about, see {Exporter.__module__}.Exporter"


def _report_nothing(_: float) -> None:
    """Discard a share."""


_UNFINISHED = ".part"
"""End of the name of a folder whose export is under way."""
_BUILT_IN = member_names(exporters)
PLUGINS = PluginGroup("mimics_app.exporters", _fault_of)


def exporter_names() -> list[str]:
    """Return the names of all exporters: built-in first, then installed plug-ins."""
    return [*_BUILT_IN, *sorted(set(PLUGINS.names()) - set(_BUILT_IN))]


def find_exporter(name: str) -> Exporter:
    """Return an exporter.

    Raises:
        UsageError: There is none of this name, or its plug-in cannot be loaded.
    """
    require_choice(name, exporter_names(), "exporter")
    if name in _BUILT_IN:
        return load_member(exporters, name, "EXPORTER", Exporter)  # type: ignore[type-abstract]
    try:
        return cast(Exporter, PLUGINS.load(name))
    except PluginError as error:
        raise UsageError(f'the exporter "{name}" is not available: {error}') from error


def export_run(run: Run, name: str, folder: Path, progress: Callable[[float], None] = _report_nothing) -> list[Path]:
    """Export a recording into a new or empty folder; return the files.

    They are written into a hidden folder beside it, which gets its name when all are whole: what interrupts an export
    leaves nothing under the final name.

    Args:
        run: The recording.
        name: Name of the exporter.
        folder: The folder.
        progress: Called with the share of the recording that was read, 0 to 1.

    Raises:
        UsageError: The exporter is unknown, it lacks its library, or its plug-in raises an error.
        OutputError: The folder has files already, or a file cannot be written.
    """
    exporter = find_exporter(name)
    scratch = folder.with_name(f".{folder.name}{_UNFINISHED}")
    run.reading = progress
    try:
        if folder.exists() and any(folder.iterdir()):
            raise OutputError(folder, "this folder is not empty", "name another one")
        if scratch.exists():  # of an export that was killed
            rmtree(scratch)
        scratch.mkdir(mode=PRIVATE_FOLDER, parents=True)
        files = list(exporter.open(run, scratch))
        scratch.replace(folder)
        return [folder / file.relative_to(scratch) for file in files]
    except OSError as error:
        raise OutputError(folder, f"cannot be written: {error.strerror or error}", "name another folder") from error
    except Exception as error:
        if isinstance(error, MimicsError) or name in _BUILT_IN:
            raise
        raise UsageError(f'the exporter "{name}" failed: it {raised(error)}') from error
    finally:
        rmtree(scratch, ignore_errors=True)
