"""`mimics study new|run|form|status|next|export|erase`: what each verb does."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.study.forms import SHIPPED_FORMS, Form, check_answers, item_words
from mimics_app.app.study.protocol import scene_of
from mimics_app.app.study.studies import codes_in, recorded_codes, studies_in
from mimics_app.app.study.study_export import export_study
from mimics_app.app.study.study_folder import Participant, StudyFolder
from mimics_app.app.study.study_runs import Next, find_next, play_next
from mimics_app.app.terminal.output import answer
from mimics_app.app.terminal.participant_language import usual_language
from mimics_app.contracts.errors import PartialDataError, UsageError, nearest
from mimics_app.contracts.system.language import speaking, spoken, translated
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.json_text import parse_object

__all__ = ["VERBS", "do_verb"]

_MOST_BYTES = 1_000_000
"""Longest file of answers."""
_RUNS = Path("runs")
"""Where `mimics run` records."""
_EMPTY = {
    "format": "mimics study",
    "version": 1,
    "title": "",
    "seed": 1,
    "sessions": 1,
    "conditions": {},
    "blocks": [],
}


def do_verb(args: argparse.Namespace) -> int:
    """Do a verb; return the exit code."""
    words = list(args.words)
    if not words and str(args.scene) == "status":
        return _list_studies(args)
    if not words:
        raise UsageError(f"mimics study {args.scene}: the folder of the study is missing")
    return VERBS[str(args.scene)](args, Path(words[0]), words[1:])


def _new(args: argparse.Namespace, folder: Path, scenes: list[str]) -> int:
    if (args.protocol is None) == (not scenes):
        raise UsageError(
            "a new study needs scenes or a protocol", "mimics study new FOLDER SCENE SCENE, or --protocol FILE"
        )
    if args.protocol is not None:
        protocol = parse_object(read_regular(args.protocol))
    else:
        conditions = {Path(scene).stem: {"scene": str(_absolute(scene))} for scene in scenes}
        blocks = [{"conditions": list(conditions), "order": args.order}]
        protocol = {
            **_EMPTY,
            "seed": args.seed,
            "sessions": args.sessions,
            "conditions": conditions,
            "blocks": blocks,
            "forms": {name: msgspec.to_builtins(_shipped(name)) for name in args.form},
        }
    study = StudyFolder.create(folder, protocol)
    counts = {"conditions": len(study.protocol.conditions), "sessions": study.protocol.sessions}
    answer(args, {"verb": "new", "folder": folder, **counts}, [str(study.protocol_file)])
    return 0


def _shipped(name: str) -> Form:
    if name not in SHIPPED_FORMS:
        raise UsageError(f'there is no shipped form "{name}"', nearest(name, SHIPPED_FORMS))
    return SHIPPED_FORMS[name]


def _form(args: argparse.Namespace, folder: Path, words: list[str]) -> int:
    """Take the answers to a form; without any, show it."""
    study = StudyFolder(folder)
    if len(words) < 2:
        raise UsageError("the participant or the form is missing", "mimics study form FOLDER P07 FORM ITEM=VALUE ..")
    name = words[1]
    form = study.protocol.forms.get(name)
    if form is None:
        raise UsageError(f'the study has no form "{name}"', nearest(name, study.protocol.forms))
    participant = study.find(words[0]) if args.known else study.find_or_add(words[0])
    given: dict[str, object] = {} if args.answers is None else _answers(args.answers)
    for word in words[2:]:
        item, equals, value = word.partition("=")
        if not equals:
            raise UsageError(f'"{word}" is not an answer', "give ITEM=VALUE")
        given[item] = value
    about = {"verb": "form", "participant": participant.code, "form": name}
    session = find_next(study, participant).session
    if args.answers is None and not given:
        with speaking(participant.language or spoken()):
            lines = [translated(form.title), *(item_words(*item) for item in form.items.items())]
        answered = max((line["session"] for line in study.answers_of(participant) if line["form"] == name), default=0)
        shown = {"title": form.title, "items": msgspec.to_builtins(form.items), "session": session}
        shown |= {"answered": answered} if answered else {}
        answer(args, {**about, **shown}, lines)
        return 0
    answers = check_answers(form, given)
    study.write_answers(participant, name, session, answers)
    answer(args, {**about, "session": session, "answers": answers}, [f"{form.title}: {len(answers)} answers are kept"])
    return 0


def _answers(file: Path) -> dict[str, object]:
    """Return the answers of a file; of standard input, which no list of processes and no folder shows, for "-"."""
    try:
        at_stdin = file == Path("-")
        return parse_object(sys.stdin.buffer.read(_MOST_BYTES) if at_stdin else read_regular(file, _MOST_BYTES))
    except ValueError as error:
        raise UsageError(f"{file}: no answers: {error}", 'write them as JSON, such as {"age": 61}') from error


def _absolute(scene: str) -> str:
    """Return the path of a scene file for any working folder; the name of a shipped scene as it is."""
    path = Path(scene)
    return str(path.resolve()) if path.is_file() else scene


def _person(args: argparse.Namespace, study: StudyFolder, words: list[str], *, add: bool = False) -> Participant:
    if add and args.person:
        return study.of_name(args.person)
    if len(words) != 1:
        raise UsageError("the code of one participant is missing", f"mimics study {args.scene} FOLDER P07")
    return study.find_or_add(words[0]) if add else study.find(words[0])


def _run(args: argparse.Namespace, folder: Path, words: list[str]) -> int:
    study = StudyFolder(folder)
    participant = _person(args, study, words, add=True)
    if args.language:
        participant = study.with_settings(participant, language=args.language)
    chosen = "resume" if args.resume else "restart" if args.restart_block else "abandon" if args.abandon else ""
    attempt = play_next(study, participant, chosen, shlex.split(args.options))  # type: ignore[arg-type]
    if attempt is None:
        answer(args, {"verb": "run", "participant": participant.code, "over": True}, ["all runs are done"])
        return 0
    found = {"run": attempt.run, "attempt": attempt.attempt, "outcome": attempt.outcome, "run_dir": attempt.folder}
    lines = [f"run {attempt.run}: {attempt.outcome}", *([str(attempt.folder)] if attempt.folder else [])]
    answer(
        args, {"verb": "run", "participant": participant.code, **found}, [*lines, _words(find_next(study, participant))]
    )
    return PartialDataError.exit_code if attempt.outcome == "interrupted" else 0


def _next(args: argparse.Namespace, folder: Path, words: list[str]) -> int:
    study = StudyFolder(folder)
    found = find_next(study, _person(args, study, words))
    answer(args, {"verb": "next", **_described(found)}, [_words(found)])
    return 0


def _described(found: Next) -> dict[str, Any]:
    about: dict[str, Any] = {"participant": found.participant.code, "session": found.session, "over": found.run is None}
    if found.run is not None:
        about |= {"run": found.run.number, "condition": found.run.condition}
    if found.interrupted is not None:
        about |= {"interrupted_attempt": found.interrupted.attempt, "resume_at": found.resume_at}
    return about


def _words(found: Next) -> str:
    if found.run is None:
        return f"{found.participant.code}: all runs are done"
    text = f"{found.participant.code}: next is run {found.run.number} of session {found.session}, {found.run.condition}"
    if found.interrupted is None:
        return text
    return f"{text}; it was interrupted: --resume (at trial {found.resume_at}), --restart-block or --abandon"


def _status(args: argparse.Namespace, folder: Path, words: list[str]) -> int:
    study = StudyFolder(folder)
    rows = []
    for participant in [study.find(word) for word in words] or study.participants:
        attempts = [each for session in study.sessions_of(participant) for each in study.attempts(participant, session)]
        outcomes = [attempt.outcome for attempt in attempts if attempt.run]
        planned = sum(len(study.plan(participant, n)) for n in range(1, study.protocol.sessions + 1))
        counts = {name: outcomes.count(name) for name in ("done", "interrupted", "abandoned")}
        rows.append({**_described(find_next(study, participant)), "planned": planned, **counts})
    lines = [f"{row['participant']}: {row['done']} of {row['planned']} runs done" for row in rows]
    scenes = {name: str(scene_of(study.protocol_file, each)) for name, each in study.protocol.conditions.items()}
    forms = {name: form.title for name, form in study.protocol.forms.items()}
    about = {"verb": "status", "title": study.title, "participants": rows, "scenes": scenes, "forms": forms}
    answer(args, about, lines or ["no participants yet"])
    return 0


def _list_studies(args: argparse.Namespace) -> int:
    """List the studies of the working folder and their participants, and who was recorded here without a study."""
    studies = {each.name: codes_in(each) for each in studies_in(Path())}
    recorded = recorded_codes(_RUNS)
    about = {"verb": "status", "studies": studies, "recorded": recorded}
    lines = [f"{name}: {', '.join(codes) or 'no participants yet'}" for name, codes in studies.items()]
    answer(args, about, [*(lines or ["no studies here"]), *([f"recorded: {', '.join(recorded)}"] if recorded else [])])
    return 0


def _export(args: argparse.Namespace, folder: Path, words: list[str]) -> int:
    if words:
        raise UsageError("export takes the folder of the study and no more", "--out DIR names the folder of the tables")
    with speaking(args.language or usual_language()):
        files = export_study(StudyFolder(folder), args.out)
    answer(args, {"verb": "export", "files": files}, map(str, files))
    return 0


def _erase(args: argparse.Namespace, folder: Path, words: list[str]) -> int:
    study = StudyFolder(folder)
    participant = _person(args, study, words)
    left = study.erase(participant)
    lines = (
        [f"{participant.code} is erased; no file of the study names this participant"] if not left else map(str, left)
    )
    answer(args, {"verb": "erase", "participant": participant.code, "left": left}, lines)
    return PartialDataError.exit_code if left else 0


VERBS: dict[str, Callable[[argparse.Namespace, Path, list[str]], int]] = {
    "new": _new,
    "run": _run,
    "form": _form,
    "status": _status,
    "next": _next,
    "export": _export,
    "erase": _erase,
}
"""What each verb does, from its arguments, the folder of the study and the words after it."""
