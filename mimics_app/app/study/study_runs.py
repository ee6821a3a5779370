"""Runs of a study: what is next for a participant, and how it is played, resumed, begun again or given up."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import msgspec

from mimics_app.app.scenes.loading import read_scene
from mimics_app.app.scenes.mirrored_scene import why_not_mirrored
from mimics_app.app.scenes.person_edit import FitFile
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.settings import NOT_FITTED, SIDES, Side
from mimics_app.app.study.own_bodies import own_body_of
from mimics_app.app.study.protocol import PlannedRun, scene_of, seed_of
from mimics_app.app.study.study_folder import Attempt, Participant, StudyFolder
from mimics_app.app.terminal.output import say
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.calibration_record import newest_of
from mimics_app.contracts.messages.trial_counts import SESSION_ENDED
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.calibrations import calibration_of
from mimics_app.recording.event_log import to_json
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import PRIVATE_FOLDER, write_atomically

__all__ = [
    "CALIBRATION",
    "Answer",
    "Next",
    "calibrate",
    "find_next",
    "play_next",
    "side_of",
    "why_not_sided",
    "words_of_settings",
]

Answer = Literal["", "resume", "restart", "abandon"]
"""What the operator chooses for a run that was interrupted; "": nothing yet."""

CALIBRATION = "calibration"
"""Scene of a calibration, and name of its condition where the plan has none."""
_UNPLANNED = 0
"""Number of the run of a calibration that is not in the plan; the planned ones begin at 1."""

_Player = Callable[[Sequence[str]], int]
"""Plays a session from the arguments of `mimics run`; returns its exit code."""

_FIT = "fit.json"
"""File beside a run folder: calibration and limits to which the run is fitted."""
_LAST_STATE = "done"
"""State of the task after its last trial."""


@dataclass(frozen=True, slots=True)
class Next:
    """What comes next for a participant.

    Attributes:
        participant: The participant.
        session: Number of the session, 1 first.
        run: The planned run; None where the study is over for the participant.
        interrupted: The attempt that was interrupted, None where the run has not begun.
        resume_at: Trial at which that attempt can be resumed, 1 first; 1 without one.
    """

    participant: Participant
    session: int
    run: PlannedRun | None
    interrupted: Attempt | None = None
    resume_at: int = 1


def find_next(study: StudyFolder, participant: Participant) -> Next:
    """Return the first planned run that is neither done nor abandoned."""
    for session in range(1, study.protocol.sessions + 1):
        last = {attempt.run: attempt for attempt in study.attempts(participant, session)}
        for planned in study.plan(participant, session):
            attempt = last.get(planned.number)
            if attempt is None:
                return Next(participant, session, planned)
            if attempt.outcome == "interrupted":
                return Next(participant, session, planned, attempt, _trial_to_resume(attempt))
    return Next(participant, study.protocol.sessions, None)


def _trial_to_resume(attempt: Attempt) -> int:
    """Return the trial after the last one that ended, 1 first."""
    rows = [] if attempt.folder is None else Run(attempt.folder).trials
    ended = [row["trial"] for row in rows if row.get("cause") != SESSION_ENDED and isinstance(row.get("trial"), int)]
    return max(ended) + 2 if ended else attempt.from_trial


def play_next(
    study: StudyFolder,
    participant: Participant,
    answer: Answer,
    extra: Sequence[str],
    play: _Player | None = None,
) -> Attempt | None:
    """Play the next run of a participant in a process of its own; return the attempt, None where none is left.

    Args:
        study: The study.
        participant: The participant.
        answer: For a run that was interrupted: continue at the trial after the last one, begin it again, or give it up.
        extra: Further options of `mimics run`, such as --headless.
        play: Plays the session, None: as `mimics run` does.

    Raises:
        UsageError: The next run was interrupted and `answer` is "", or the other way round.
    """
    found = find_next(study, participant)
    if found.run is None:
        return None
    if (found.interrupted is None) != (answer == ""):
        raise UsageError(*_question(found, answer))
    number = found.run.number
    if answer == "abandon" and found.interrupted is not None:
        line = {"run": number, "attempt": found.interrupted.attempt, "outcome": "abandoned"}
        study.write_line(participant, found.session, line)
        return study.attempts(participant, found.session)[-1]
    attempt = 1 if found.interrupted is None else found.interrupted.attempt + 1
    from_trial = found.resume_at if answer == "resume" else 1
    condition = study.protocol.conditions[found.run.condition]
    scene = scene_of(study.protocol_file, condition)
    folder = study.attempt_folder(participant, found.session, number, attempt)
    options = ["--seed", str(found.run.seed), "--from-trial", str(from_trial), "--difficulty", condition.difficulty]
    options += ["--trials", str(condition.trials)] if condition.trials else []
    options += words_of_settings(study, participant, scene)
    begun = {"run": number, "attempt": attempt, "condition": found.run.condition, "from_trial": from_trial}
    words = [str(scene), *options, *condition.options, *extra]
    return _journalled(study, participant, found.session, begun, folder, words, play or _play)


def calibrate(
    study: StudyFolder, participant: Participant, extra: Sequence[str], play: _Player | None = None
) -> Attempt:
    """Calibrate a participant outside the plan; what was measured is kept, and later runs are fitted to it.

    Args:
        study: The study.
        participant: The participant.
        extra: Further options of `mimics run`, such as --headless.
        play: Plays the session, None: as `mimics run` does.
    """
    session = find_next(study, participant).session
    attempt = 1 + sum(each.run == _UNPLANNED for each in study.attempts(participant, session))
    folder = study.attempt_folder(participant, session, _UNPLANNED, attempt)
    seed = seed_of(study.protocol.seed, participant.code, session, CALIBRATION, attempt)
    scene = find_scene(Path(CALIBRATION))
    words = [str(scene), "--seed", str(seed), *words_of_settings(study, participant, scene), *extra]
    begun = {"run": _UNPLANNED, "attempt": attempt, "condition": CALIBRATION, "from_trial": 1}
    return _journalled(study, participant, session, begun, folder, words, play or _play)


def _journalled(
    study: StudyFolder,
    participant: Participant,
    session: int,
    begun: Mapping[str, object],
    folder: Path,
    words: Sequence[str],
    play: _Player,
) -> Attempt:
    """Play a run between its two lines of the journal, and keep what it calibrated; return the attempt."""
    study.write_line(participant, session, begun)
    folder.mkdir(mode=PRIVATE_FOLDER)
    code = play([*words, *_fitted(study, participant, folder), "--runs", str(folder)])
    number, attempt = begun["run"], begun["attempt"]
    played = _attempt(study, participant, session, begun).folder
    outcome = "done" if code == 0 and _ended_whole(played) else "interrupted"
    if played is not None and (calibration := calibration_of(Run(played))) is not None:
        study.write_calibration(participant, session, calibration)
    study.write_line(participant, session, {"run": number, "attempt": attempt, "outcome": outcome, "code": code})
    return _attempt(study, participant, session, begun)


def _attempt(study: StudyFolder, participant: Participant, session: int, begun: Mapping[str, object]) -> Attempt:
    """Return an attempt by the line of its begin: the same person may have begun another one since.

    Raises:
        UsageError: It is not there any more.
    """
    for each in study.attempts(participant, session):
        if (each.run, each.attempt) == (begun["run"], begun["attempt"]):
            return each
    what = phrase("{code} was erased during the session", code=participant.code)
    raise UsageError(what, phrase("nothing of it is kept"))


def _question(found: Next, answer: Answer) -> tuple[str, str]:
    """Return what is to be decided, and how."""
    if found.interrupted is None:
        return f"nothing was interrupted that --{answer} could concern", "leave the option out"
    planned = found.run
    what = f"run {found.interrupted.run} ({planned.condition if planned else ''}) was interrupted"
    return what, f"--resume (at trial {found.resume_at}), --restart-block or --abandon"


def _play(words: Sequence[str]) -> int:
    """Play a session as `mimics run` does, with its answer among the messages."""
    return subprocess.run(
        [sys.executable, "-m", "mimics_app", "run", *words], stdout=sys.stderr, check=False
    ).returncode


def words_of_settings(study: StudyFolder, participant: Participant, scene: Path) -> list[str]:
    """Return the options of `mimics run` for a participant's code, language, side, text, contrast and own body.

    The protocol says whether a run is fitted, and within which limits: so no calibration is searched by the code.
    """
    words = [f"--participant={participant.code}", f"--fit={NOT_FITTED}", *_sided(study, participant, scene)]
    body = own_body_of(study, participant, scene)
    if body.why_not:
        say(body.why_not)
    words += [] if body.file is None else [f"--avatar={body.file}"]
    words += [f"--language={participant.language}"] if participant.language else []
    words += ["--larger-text"] if participant.text == "larger" else []
    return [*words, *(["--high-contrast"] if participant.contrast == "high" else [])]


def _fitted(study: StudyFolder, participant: Participant, folder: Path) -> list[str]:
    """Return the option that fits a run to the newest calibration of a participant; without one, or not wanted: []."""
    calibrations = study.calibrations_of(participant)
    if not calibrations or not study.protocol.fitting.on:
        return []
    newest = newest_of([calibration for _, calibration in calibrations])
    file = folder / _FIT
    write_atomically(file, to_json(msgspec.to_builtins(FitFile(newest, study.protocol.fitting))))
    return [f"--fit={file}"]


def side_of(study: StudyFolder, participant: Participant) -> Side:
    """Return the side that plays: that of the participant, else the affected or, without one, preferred one."""
    answers = {item: value for line in study.answers_of(participant) for item, value in line["answers"].items()}
    stated = participant.side, answers.get("side")  # as answered last, which may be that there is none
    side = next((each for each in stated if each in SIDES), answers.get("hand"))
    return "left" if side == "left" else "right"


def _sided(study: StudyFolder, participant: Participant, scene: Path) -> list[str]:
    """Return the option for the side of a participant; a scene without a mirror image: []."""
    why = why_not_sided(study, participant, scene)
    if why:
        say(f"{scene.stem} is played as it is, not on the left side: {why}")
    return [] if why or side_of(study, participant) == "right" else ["--side=left"]


def why_not_sided(study: StudyFolder, participant: Participant, scene: Path) -> str:
    """Return why a scene is not played on the participant's left side; "" where it is, or the side is the right."""
    return "" if side_of(study, participant) == "right" else why_not_mirrored(read_scene(scene).document)


def _ended_whole(folder: Path | None) -> bool:
    """Whether a run came to the end of its last trial."""
    if folder is None:
        return False
    states = Run(folder).lines_of("app", "state")
    return bool(states) and states[-1].get("state") == _LAST_STATE
