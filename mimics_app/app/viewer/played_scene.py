"""Play from the editor: a session of the scene as it is edited, in a process and a window of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from mimics_app.app.play.journey_log import JourneyLog, read_journey
from mimics_app.app.viewer.edited_scene import EditedScene
from mimics_app.app.viewer.inspected import object_of
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import read_or_nothing
from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.world.files.reading.json_edit import set_value, source_of

__all__ = ["PlayedScene"]

_OWNER = "x-viewer"
"""Key of a copy that the scene does not have: the process that made it."""

_LONGEST_END_S = 20.0
"""Time in which a session has closed its recording, whatever the disk [s]."""


class PlayedScene:
    """One session of an edited scene.

    What is not saved is played from a file beside the scene, which goes at its end. One that a killed viewer has left
    gives way to the next.

    Args:
        edited: The scene.

    Raises:
        SceneError: Unsaved edits of an included file, which only that file can show; or the folder takes no file.
    """

    def __init__(self, edited: EditedScene) -> None:
        texts = edited.texts
        main, *included = texts.files
        unsaved = [file for file in included if file in texts.unsaved]
        if unsaved:
            raise SceneError(Issue(str(unsaved[0]), "", "has edits that are not saved", "Ctrl + S, then play"))
        self._file: Path | None = None
        if main in texts.unsaved:
            self._file = _written_beside(main, _named(texts.text(main), edited))
        self._runs = tempfile.TemporaryDirectory(prefix="mimics-")
        self._log, self._said = (Path(self._runs.name) / name for name in ("journey.jsonl", "said.txt"))
        JourneyLog(self._log).taken()  # the viewer's own window was there all the time
        words = ["run", str(self._file or main), "--runs", self._runs.name, "--journey", str(self._log)]
        with self._said.open("wb") as said:
            command = [sys.executable, "-m", "mimics_app", *words]
            self._child = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT)

    @property
    def doing(self) -> str:
        """What a session does until its picture is there; "" from then on."""
        noted = read_journey(self._log)
        return "" if noted.get("shown") else str(noted.get("doing", ""))

    def outcome(self) -> str | None:
        """Return why a session has failed, "" for one that ended well; None before its end. Nothing of it stays."""
        status = self._child.poll()
        if status is None:
            return None
        said = read_or_nothing(self._said).decode(errors="replace").split("\n")
        why = read_journey(self._log).get("error") or next(filter(None, reversed(said)), f"it ended with {status}")
        self._clean()
        return str(why) if status else ""

    def end(self) -> None:
        """End the session, as a person who leaves would."""
        if self._child.poll() is None:
            self._child.terminate()
            try:
                self._child.wait(_LONGEST_END_S)
            except subprocess.TimeoutExpired:
                self._child.kill()
                self._child.wait()
        self._clean()

    def _clean(self) -> None:
        if self._file is not None:
            self._file.unlink(missing_ok=True)
        self._runs.cleanup()


def _named(text: str, edited: EditedScene) -> str:
    """Give the copy the name and scenario that the file's own name stands for, and name this process in it."""
    scene = edited.scene
    for key, value in (("name", scene.name), ("scenario", scene.scenario), (_OWNER, os.getpid())):
        text = set_value(text, [key], source_of(value))
    return text


def _written_beside(main: Path, text: str) -> Path:
    """Write the copy; its name is what the person sees while the session starts."""
    path = main.with_name(f"{main.stem} as edited.json")
    try:
        if _is_left_over(path):
            path.unlink()
        with whole_file(path), path.open("x", encoding="utf-8", newline="") as stream:
            stream.write(text)
    except OSError as error:
        what = f"cannot be written, to play what is not saved: {error.strerror}"
        raise SceneError(Issue(str(path), "", what, "save, then play")) from None
    return path


def _is_left_over(path: Path) -> bool:
    """Whether a file is the copy of a viewer that does not run any more."""
    try:
        owner = object_of(json.loads(read_or_nothing(path))).get(_OWNER)
        if isinstance(owner, int):
            os.kill(owner, 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError, ValueError):  # somebody else's process, or somebody else's file
        return False
    return False
