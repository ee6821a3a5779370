"""Folder of a study: its protocol, its participants, their sessions, and where the names of the participants are.

    STUDY/study.json                            protocol
    STUDY/participants.jsonl                    code, row of the squares and settings of each participant
    STUDY/sub-CODE/answers.jsonl                forms and questionnaires as answered, a line each time
    STUDY/sub-CODE/calibrations.jsonl           what calibrations found, a line each time
    STUDY/sub-CODE/notes.jsonl                  notes, a line each
    STUDY/sub-CODE/ses-001/journal.jsonl        what began and ended
    STUDY/sub-CODE/ses-001/run-003-1/RUN        run folder of the first attempt at the third run
    STUDY/sub-CODE/ses-001/run-000-1/RUN        run folder of a calibration that is not in the plan
    STUDY.keys.json                             names behind the codes, beside the folder: never in it

A line of a journal is on the disk before a run begins, so that a crash at any moment is seen afterwards. Nothing is
overwritten: another attempt has a folder of its own.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from urllib.parse import quote

import msgspec

from mimics_app.app.study.forms import Answer
from mimics_app.app.study.protocol import PlannedRun, Protocol, plan_of, read_protocol
from mimics_app.app.terminal.participant import canonical_code, why_no_code
from mimics_app.contracts.clock import wall_time
from mimics_app.contracts.errors import Issue, OutputError, SceneError, UsageError, first_line, nearest
from mimics_app.contracts.messages.calibration_record import Calibration
from mimics_app.contracts.system.alone import alone_in
from mimics_app.contracts.system.phrases import phrase
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.event_log import to_json
from mimics_app.recording.json_text import parse_object
from mimics_app.recording.run_folder import PRIVATE_FILE, PRIVATE_FOLDER, write_atomically

__all__ = ["Attempt", "Participant", "StudyFolder", "folder_name"]

_PROTOCOL, _PARTICIPANTS, _JOURNAL = "study.json", "participants.jsonl", "journal.jsonl"
_ANSWERS, _CALIBRATIONS, _NOTES = "answers.jsonl", "calibrations.jsonl", "notes.jsonl"
_SETTINGS = ("language", "side", "text", "contrast", "avatar")
_LONGEST_NAME = 120
"""Longest name of a participant's folder; a file system takes 255 bytes."""
_NEW_CODE = "P{:03d}"


@dataclass(frozen=True, slots=True)
class Participant:
    """A participant.

    Attributes:
        code: Pseudonym.
        row: Row of the squares, 0 first.
        language: Language of the texts that the participant sees, see `contracts.system.language`; "": the usual one.
        side: Side that plays, "left" or "right"; "": as the forms say.
        text: "larger": what is over the picture is enlarged; "": as a calibration says.
        contrast: "high": texts, targets and paths have the colours of high contrast; "": the usual ones.
        avatar: Model that is the participant's own body, a path from the study's folder; "": as the scene has it.
    """

    code: str
    row: int
    language: str = ""
    side: str = ""
    text: str = ""
    contrast: str = ""
    avatar: str = ""

    @property
    def line(self) -> bytes:
        """The line of the participant in the list of all."""
        stated = {name: value for name in _SETTINGS if (value := getattr(self, name))}
        return to_json({"participant": self.code, "row": self.row, **stated}) + b"\n"


@dataclass(frozen=True, slots=True)
class Attempt:
    """One attempt at a planned run.

    Attributes:
        run: Number of the planned run, 1 first.
        attempt: Number of the attempt, 1 first.
        outcome: "done", "interrupted" or "abandoned".
        from_trial: First trial, 1 first.
        folder: Its run folder, None where none was made.
    """

    run: int
    attempt: int
    outcome: str
    from_trial: int
    folder: Path | None


class StudyFolder:
    """A study on the disk.

    Attributes:
        path: Its folder.
        protocol: Its protocol.
    """

    def __init__(self, path: Path) -> None:
        if not (path / _PROTOCOL).is_file():
            raise SceneError(
                Issue(
                    str(path), "", phrase("is not the folder of a study"), phrase("mimics study new FOLDER makes one")
                )
            )
        self.path = path
        self.protocol: Protocol = read_protocol(path / _PROTOCOL)

    @classmethod
    def create(cls, path: Path, protocol: Mapping[str, Any]) -> StudyFolder:
        """Make the folder of a new study.

        Raises:
            OutputError: It exists already.
            SceneError: The protocol is faulty; nothing is made.
        """
        scratch = path.with_name(f".{path.name}.part")
        shutil.rmtree(scratch, ignore_errors=True)
        try:
            if os.path.lexists(path) and any(path.iterdir()):
                what, fix = phrase("this folder is not empty"), phrase("name another one: no study is overwritten")
                raise OutputError(path, what, fix)
            scratch.mkdir(mode=PRIVATE_FOLDER, parents=True)
            write_atomically(scratch / _PROTOCOL, json.dumps(protocol, indent=2, ensure_ascii=False).encode() + b"\n")
            read_protocol(scratch / _PROTOCOL)
            scratch.replace(path)
        except OSError as error:
            what = phrase("cannot be made: {why}", why=error.strerror or error)
            raise OutputError(path, what, phrase("name another folder")) from error
        finally:
            shutil.rmtree(scratch, ignore_errors=True)
        return cls(path)

    @property
    def title(self) -> str:
        """Title for the reports."""
        return self.protocol.title or self.path.resolve().name

    @property
    def protocol_file(self) -> Path:
        """The file of the protocol."""
        return self.path / _PROTOCOL

    @property
    def key_file(self) -> Path:
        """File with the names behind the codes, beside the folder."""
        resolved = self.path.resolve()
        return resolved.with_name(f"{resolved.name}.keys.json")

    @property
    def participants(self) -> list[Participant]:
        """All participants in the order in which they were added."""
        lines = _lines(self.path / _PARTICIPANTS, participant=str, row=int)
        return [
            Participant(line["participant"], line["row"], *(str(line.get(name, "")) for name in _SETTINGS))
            for line in lines
        ]

    def find(self, text: str) -> Participant:
        """Return a participant by code.

        Raises:
            UsageError: There is none.
        """
        code, known = canonical_code(text), self.participants
        found = next((each for each in known if each.code == code), None)
        if found is None:
            raise UsageError(
                phrase('there is no participant "{code}"', code=code), nearest(code, [each.code for each in known])
            )
        return found

    def find_or_add(self, text: str) -> Participant:
        """Return a participant by code, who is added where there is none.

        Raises:
            UsageError: The text is no code.
        """
        code = canonical_code(text)
        why = why_no_code(code) or ("" if code else phrase("a participant has a code, such as P07"))
        if why:
            raise UsageError(f'"{code}": {why}')
        with alone_in(self.path):
            return self._find_or_add(code)

    def _find_or_add(self, code: str) -> Participant:
        known = self.participants
        for each in known:
            if each.code == code:
                return each
        added = Participant(code, max((each.row for each in known), default=-1) + 1)
        self._append(self.path / _PARTICIPANTS, {"participant": added.code, "row": added.row})
        self.folder_of(added).mkdir(mode=PRIVATE_FOLDER)
        return added

    def of_name(self, name: str) -> Participant:
        """Return the participant with a name, from the key file, where a new code is entered for a new name.

        Raises:
            SceneError: The key file or the list of participants cannot be read.
        """
        with alone_in(self.path):
            names = self._names()
            code = next((code for code, each in names.items() if each == canonical_code(name)), None)
            if code is None:
                taken = {each.code for each in self.participants} | names.keys()
                code = next(text for n in range(1, len(taken) + 2) if (text := _NEW_CODE.format(n)) not in taken)
                write_atomically(self.key_file, to_json({**names, code: canonical_code(name)}))
            return self._find_or_add(code)

    def _names(self) -> dict[str, str]:
        """Return the names by code.

        Raises:
            SceneError: The key file cannot be read, and would lose all names if it were written.
        """
        data = _content(self.key_file)
        try:
            return {code: str(name) for code, name in parse_object(data).items()} if data else {}
        except ValueError as error:
            what = phrase("does not hold the names of participants: {why}", why=first_line(error))
            raise SceneError(Issue(str(self.key_file), "", what, phrase("restore the file"))) from error

    def with_settings(self, participant: Participant, **settings: str) -> Participant:
        """Keep settings of a participant, by their fields, for all runs that follow; return the participant."""
        with alone_in(self.path):
            listed = {each.code: each for each in self.participants}
            changed = replace(listed.get(participant.code, participant), **settings)  # type: ignore[arg-type]
            lines = ((changed if code == changed.code else each).line for code, each in listed.items())
            write_atomically(self.path / _PARTICIPANTS, b"".join(lines))
        return changed

    def folder_of(self, participant: Participant) -> Path:
        """Return the folder of a participant."""
        return self.path / f"sub-{folder_name(participant.code)}"

    def plan(self, participant: Participant, session: int) -> list[PlannedRun]:
        """Return the runs of a session."""
        return plan_of(self.protocol, participant.code, participant.row, session)

    def attempts(self, participant: Participant, session: int) -> list[Attempt]:
        """Return the attempts of a session in order; one that began and has no end was interrupted."""
        journal = self._session(participant, session) / _JOURNAL
        found: dict[tuple[int, int], Attempt] = {}
        for line in _lines(journal, run=int, attempt=int):
            key = line["run"], line["attempt"]
            folder = self.attempt_folder(participant, session, *key)
            runs = sorted(folder.glob("*_*")) if folder.is_dir() else []
            outcome = line.get("outcome", "interrupted")
            begun = found.get(key)
            from_trial = begun.from_trial if begun else line.get("from_trial", 1)
            found[key] = Attempt(*key, outcome, from_trial, runs[-1] if runs else None)
        return list(found.values())

    def attempt_folder(self, participant: Participant, session: int, run: int, attempt: int) -> Path:
        """Return the parent of the run folder of an attempt."""
        return self._session(participant, session) / f"run-{run:03d}-{attempt}"

    def write_line(self, participant: Participant, session: int, line: Mapping[str, object]) -> None:
        """Append a line to the journal of a session; it is on the disk when this returns."""
        folder = self._session(participant, session)
        folder.mkdir(mode=PRIVATE_FOLDER, exist_ok=True)
        self._append(folder / _JOURNAL, {**line, "utc": wall_time().isoformat()})

    def write_answers(self, participant: Participant, form: str, session: int, answers: Mapping[str, Answer]) -> None:
        """Append the answers to a form; earlier ones stay. They are on the disk when this returns."""
        line = {"form": form, "session": session, "answers": answers, "utc": wall_time().isoformat()}
        self._append(self.folder_of(participant) / _ANSWERS, line)

    def answers_of(self, participant: Participant) -> list[dict[str, Any]]:
        """Return the answers of a participant in order: form, session, answers and utc of each time."""
        return _lines(self.folder_of(participant) / _ANSWERS, form=str, session=int, answers=dict)

    def write_calibration(self, participant: Participant, session: int, calibration: Calibration) -> None:
        """Append what a calibration found; earlier ones stay. It is on the disk when this returns."""
        line = {"session": session, "calibration": msgspec.to_builtins(calibration)}
        self._append(self.folder_of(participant) / _CALIBRATIONS, line)

    def calibrations_of(self, participant: Participant) -> list[tuple[int, Calibration]]:
        """Return session and result of each calibration of a participant, in order.

        Raises:
            SceneError: The file is damaged.
        """
        file = self.folder_of(participant) / _CALIBRATIONS
        try:
            return [(int(line["session"]), msgspec.convert(line["calibration"], Calibration)) for line in _lines(file)]
        except (msgspec.ValidationError, KeyError, ValueError) as error:
            what = phrase("does not hold calibrations: {why}", why=first_line(error))
            raise SceneError(Issue(str(file), "", what, phrase("restore the file, or remove it"))) from error

    def write_note(self, participant: Participant, session: int, note: str) -> None:
        """Append a note of one line; earlier ones stay. It is on the disk when this returns."""
        line = {"session": session, "note": note, "utc": wall_time().isoformat()}
        self._append(self.folder_of(participant) / _NOTES, line)

    def notes_of(self, participant: Participant) -> list[dict[str, Any]]:
        """Return the notes about a participant in order: session, note and utc."""
        return _lines(self.folder_of(participant) / _NOTES, note=str, utc=str)

    def sessions_of(self, participant: Participant) -> list[int]:
        """Return the numbers of the sessions that began."""
        return sorted(
            int(each.name[4:]) for each in self.folder_of(participant).glob("ses-*") if each.name[4:].isdigit()
        )

    def erase(self, participant: Participant) -> list[Path]:
        """Remove all files of a participant, the code among the participants and the name among the keys.

        Returns:
            The files in which the code or the name is still found: none, unless somebody put them there. One that
            cannot be read is among them.

        Raises:
            SceneError: The list of the participants or of the names cannot be read; nothing is removed.
        """
        with alone_in(self.path):
            names = self._names()
            kept = [each for each in self.participants if each.code != participant.code]
            folder = self.folder_of(participant)
            if folder.exists():
                shutil.rmtree(folder)
            write_atomically(self.path / _PARTICIPANTS, b"".join(each.line for each in kept))
            name = names.pop(participant.code, "")
            if name:
                write_atomically(self.key_file, to_json(names))
        return self.files_about(participant.code, name)

    def files_about(self, code: str, name: str = "") -> list[Path]:
        """Return the files of the study, and the key file, that name a participant.

        Args:
            code: The code, which is sought as the value of a participant and in paths.
            name: The name, which is sought anywhere; "" for none.
        """
        texts = [rb'participant"\s*:\s*"' + text + b'"' for text in _forms(code)]
        texts += [b"sub-" + re.escape(folder_name(code).encode()) + rb"(?![\w%-])"]
        texts += _forms(name) if name else []
        sought = re.compile(b"|".join(texts))
        files = [each for each in self.path.rglob("*") if each.is_file()]
        files += [self.key_file] if self.key_file.is_file() else []
        return [each for each in files if sought.search(os.fsencode(each)) or _may_hold(each, sought)]

    def _session(self, participant: Participant, session: int) -> Path:
        return self.folder_of(participant) / f"ses-{session:03d}"

    def _append(self, file: Path, line: Mapping[str, object]) -> None:
        """Append a line, in place of one that a crash cut off, and flush it to the medium."""
        content = _content(file)
        if content and not content.endswith(b"\n"):
            os.truncate(file, content.rfind(b"\n") + 1)
        descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_APPEND, PRIVATE_FILE)
        with os.fdopen(descriptor, "ab") as stream:  # which raises on a full disk where os.write would write a part
            stream.write(to_json(line) + b"\n")
            stream.flush()
            os.fsync(descriptor)


def folder_name(code: str) -> str:
    """Return a code as the name of a folder: what no name of a file should have is written as %XX, as in a URL."""
    name = quote(code, safe=" ").replace(" ", "%20")
    if len(name) <= _LONGEST_NAME:
        return name
    return f"{name[: _LONGEST_NAME - 17]}-{hashlib.sha256(code.encode()).hexdigest()[:16]}"


def _lines(file: Path, **types: type) -> list[dict[str, Any]]:
    """Return the whole lines of a file; a last one that a crash cut off is left out.

    Args:
        file: The file; a missing one has no lines.
        types: What every line needs, by name.

    Raises:
        SceneError: The file cannot be read, or a line is damaged.
    """
    content = _content(file)
    found = []
    for number, text in enumerate(content[: content.rfind(b"\n") + 1].split(b"\n"), 1):
        if not text.strip():
            continue
        try:
            found.append(parse_object(text))
            wrong = next((name for name, kind in types.items() if not isinstance(found[-1].get(name), kind)), "")
            why = wrong and phrase('it has no "{code}"', code=wrong)
        except ValueError as error:
            why = first_line(error)
        if why:
            what = phrase("damaged line {n:d}: {why}", n=number, why=why)
            raise SceneError(Issue(str(file), "", what, phrase("restore the file, or that line")))
    return found


def _content(file: Path) -> bytes:
    """Return the bytes of a file, none of a missing one.

    Raises:
        SceneError: It cannot be read; what is written in its place would lose what it holds.
    """
    try:
        return read_regular(file)
    except FileNotFoundError:
        return b""
    except OSError as error:
        what = phrase("cannot be read: {why}", why=error.strerror or error)
        raise SceneError(Issue(str(file), "", what, phrase("ask its owner, or restore the file"))) from error


def _may_hold(file: Path, sought: re.Pattern[bytes]) -> bool:
    """Return whether a pattern is in a file, or may be: the file cannot be read."""
    try:
        return sought.search(read_regular(file)) is not None
    except OSError:
        return True


def _forms(text: str) -> list[bytes]:
    """Return the patterns of a text in a file: as UTF-8, and with the escapes of JSON."""
    forms = dict.fromkeys((text, json.dumps(text, ensure_ascii=False)[1:-1], json.dumps(text)[1:-1]))
    return [re.escape(form.encode()) for form in forms]
