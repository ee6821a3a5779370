"""Contents of the participants' pages of the launcher: list, participant, form, earlier sessions, settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from mimics_app.app.study.forms import Answer, Form, Item, check_answers
from mimics_app.app.study.own_bodies import models_of, own_body_of, why_no_model
from mimics_app.app.study.study_folder import Attempt, Participant, StudyFolder
from mimics_app.app.study.study_results import condition_scene, title_of, trials_of
from mimics_app.app.study.study_runs import CALIBRATION, Next, find_next, side_of, why_not_sided
from mimics_app.contracts.errors import MimicsError, UsageError, first_line
from mimics_app.contracts.messages.calibration_record import DIRECTIONS, MEASURE_TITLES
from mimics_app.contracts.messages.trial_counts import FINISHED
from mimics_app.contracts.system.language import LANGUAGES, translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.history import local_time
from mimics_app.recording.report_values import number
from mimics_app.rendering.visual.launcher.curve import Curve
from mimics_app.rendering.visual.launcher.form_page import FormContent, PageButton
from mimics_app.rendering.visual.launcher.setting import Setting, SettingChoice

__all__ = [
    "ADD",
    "BACK",
    "CURVES",
    "PERSON",
    "STUDY",
    "Person",
    "answers_given",
    "earlier_content",
    "fault_words",
    "form_content",
    "list_content",
    "person_content",
    "settings_content",
]

BACK, ADD, STUDY, CURVES = "back", "add", "study", "curves"
"""Names of rows: the way back, the field for a new code, the choice of a study, the choice of curves."""
PERSON = "person "
"""Begin of the name of a participant's row: a code may be that of another row, such as "back"."""
_BACK = PageButton(BACK, phrase("Back"))
_MEASURES = {
    "range": [f"ease_{name}" for name in DIRECTIONS],
    "other": ["grip", "release", "walking", "hearing_left", "hearing_right", "letter"],
}
"""Measures of a calibration by group of curves."""
_GROUPS = {
    "results": phrase("results of the tasks"),
    "range": phrase("range of motion"),
    "other": phrase("grip, walking, hearing, reading"),
    "answers": phrase("answers to the forms"),
}
_MOST_STEPS = 200
"""Largest number of steps of a scale that is chosen; on a finer one the value is typed."""
_MOST_LINES = 4
"""Number of the newest notes that are shown."""


class Person:
    """A participant with what is shown on the page; read once.

    Args:
        study: The study.
        participant: The participant.

    Attributes:
        found: What comes next.
        calibrated: Whether something was measured before.
        fits: Whether the protocol fits the tasks to a calibration.
        curves: Curves by group, those that have values.
        notes: The notes, newest first.
    """

    def __init__(self, study: StudyFolder, participant: Participant) -> None:
        self.study, self.participant = study, participant
        self.found: Next = find_next(study, participant)
        self.calibrated = bool(study.calibrations_of(participant))
        self.fits = study.protocol.fitting.on
        found = {
            "results": _results(study, participant),
            **_calibrations(study, participant),
            "answers": _answers(study, participant),
        }
        self.curves = {name: curves for name, curves in found.items() if curves}
        self.notes = [
            f"{local_time(str(line['utc']))}: {line['note']}" for line in reversed(study.notes_of(participant))
        ]

    @property
    def scene(self) -> Path | None:
        """Scene of what comes next; None where the study is over."""
        return None if self.found.run is None else condition_scene(self.study, self.found.run.condition)


def list_content(studies: Sequence[Path], study: StudyFolder | None, notice: str = "") -> FormContent:
    """Return the list of the participants of a study, with a field for a new one.

    Args:
        studies: Folders of all studies.
        study: The study, None where there is none yet.
        notice: What went wrong.
    """
    people = [] if study is None else study.participants
    rows: list[PageButton | Setting] = [_person_row(study, each) for each in people if study is not None]
    help_ = phrase("Type a code such as P07, never a name, and press Enter.")
    rows.append(Setting(ADD, phrase("New participant"), help_, typed=True, empty=phrase("type a code here")))
    if len(studies) > 1:
        choices = [SettingChoice(str(each), each.name) for each in studies]
        rows.append(Setting(STUDY, phrase("Study"), phrase("Each study has a protocol and participants."), choices))
    lines = [
        phrase("Choose a participant: to calibrate, to play what comes next, to answer forms, to see the sessions."),
        phrase("The tasks are fitted to a calibration, and have the participant's language, side and size of text."),
    ]
    words = "" if study is None else phrase("Study in {folder}", folder=study.path.resolve())
    return FormContent(
        phrase("Participants"), words, [*rows, _BACK], lines=lines, notice=notice, entered=frozenset({ADD})
    )


def _person_row(study: StudyFolder, participant: Participant) -> PageButton:
    try:
        words = _next_words(study, participant)
    except MimicsError as error:  # of a damaged file: the others can play
        words = fault_words(error)
    return PageButton(f"{PERSON}{participant.code}", participant.code, words)


def _next_words(study: StudyFolder, participant: Participant) -> str:
    found = find_next(study, participant)
    if found.run is None:
        return phrase("all sessions are done")
    title = title_of(study, found.run.condition)
    return phrase("session {session:d}, next: {title}", session=found.session, title=title)


def person_content(person: Person, group: str, player: str, notice: str = "") -> FormContent:
    """Return the page of a participant.

    Args:
        person: The participant.
        group: Group of the curves that are shown.
        player: Caption of the device.
        notice: What went wrong.
    """
    rows: list[PageButton | Setting] = [*_next_rows(person)]
    for name, form in person.study.protocol.forms.items():
        times = sum(line["form"] == name for line in person.study.answers_of(person.participant))
        rows.append(PageButton(f"form {name}", form.title, phrase("times answered: {n:d}", n=times)))
    help_ = phrase("What a therapist wants to remember; no names. Enter keeps it.")
    rows.append(Setting("note", phrase("New note"), help_, typed=True, empty=phrase("type it here")))
    rows.append(PageButton("earlier", phrase("Earlier sessions"), help=phrase("Results and report of each run.")))
    help_ = phrase("All sessions on one page, in the browser.")
    rows.append(PageButton("report", phrase("Report on the participant"), help=help_))
    if len(person.curves) > 1:
        choices = [SettingChoice(name, _GROUPS[name]) for name in person.curves]
        rows.append(Setting(CURVES, phrase("Curves"), phrase("What is shown over the sessions."), choices))
    rows.append(PageButton("settings", phrase("Language, side, text, contrast, body"), _settings_words(person)))
    shown = group if group in person.curves else next(iter(person.curves), "")
    lines = person.notes[:_MOST_LINES]
    if not person.curves:
        lines = [phrase("Curves over the sessions are shown here once something was measured."), *lines]
    return FormContent(
        phrase("Participant {code}", code=person.participant.code),
        phrase("Who plays: {player}", player=player),
        [*rows, _BACK],
        curves=person.curves.get(shown, ()),
        lines=lines,
        notice=notice,
        entered=frozenset({"note"}),
    )


def _next_rows(person: Person) -> list[PageButton]:
    """Return the buttons for what comes next; a calibration first where there is none."""
    first = person.fits and not person.calibrated
    help_ = phrase("Range of motion, grip, hearing and reading, in a few minutes; the tasks are then fitted to them.")
    words = phrase("first: the tasks are then fitted to the person") if first else phrase("the trend is in the curves")
    calibrate = PageButton("calibrate", phrase("Calibrate"), words, help_, main=first)
    found = person.found
    if found.run is None:
        return [calibrate]
    title = title_of(person.study, found.run.condition)
    count = len(person.study.plan(person.participant, found.session))
    where = phrase(
        "session {session:d}, run {n:d} of {count:d}", session=found.session, n=found.run.number, count=count
    )
    if found.interrupted is None:
        rows = [
            PageButton("play", phrase("Start: {title}", title=title), where, _changes_words(person), main=not first)
        ]
    else:
        help_ = phrase("This run was interrupted: what was recorded stays in any case.")
        label = phrase("Continue at trial {n:d}", n=found.resume_at)
        rows = [
            PageButton("resume", label, f"{title} · {where}", help_, main=not first),
            PageButton("restart", phrase("Begin the run again"), title, help_),
            PageButton("abandon", phrase("Leave the run out"), title, help_),
        ]
    return [calibrate, *rows] if first else [*rows, calibrate]


def _changes_words(person: Person) -> str:
    """Return why what comes next is not on the participant's left side, or without their own body; "" where it is."""
    if person.scene is None:
        return ""
    why = why_not_sided(person.study, person.participant, person.scene)
    if why:
        return phrase("Played as it is, not on the left side: {why}", why=why)
    return own_body_of(person.study, person.participant, person.scene).why_not


def _settings_words(person: Person) -> str:
    who = person.participant
    side = phrase("left side") if side_of(person.study, who) == "left" else phrase("right side")
    text = phrase("larger text") if who.text else ""
    contrast = phrase("high contrast") if who.contrast else ""
    body = phrase("own body") if who.avatar and not why_no_model(person.study, who) else ""
    return " · ".join(filter(None, (LANGUAGES.get(who.language, ""), side, text, contrast, body)))


def settings_content(study: StudyFolder, participant: Participant) -> FormContent:
    """Return the page of a participant's settings, by the names of their fields."""
    models = models_of(study, participant)
    languages = {"": phrase("as this page"), **LANGUAGES}
    sides = {"": phrase("as the forms say"), "left": phrase("left side"), "right": phrase("right side")}
    rows = [
        Setting("language", phrase("Language"), phrase("Of tasks, results and report."), _choices(languages)),
        Setting(
            "side", phrase("Side that plays"), phrase("Left mirrors the scenes that have a side."), _choices(sides)
        ),
        Setting(
            "text",
            phrase("Text over the picture"),
            phrase("Larger: cards and prompts of the session are larger, where the window is wide enough."),
            _choices({"": phrase("as the calibration says"), "larger": phrase("larger")}),
        ),
        Setting(
            "contrast",
            phrase("Contrast"),
            phrase("High: white on black texts; paths, targets and the hand's marker in colours that stand out."),
            _choices({"": phrase("usual"), "high": phrase("high")}),
        ),
        Setting(
            "avatar",
            phrase("Own body"),
            phrase(
                "Model of the participant, in scenes that show one's body: a file of mimics avatar make in {folder}, "
                "or the path of another.",
                folder=study.folder_of(participant),
            ),
            _choices({"": "", **{each: each for each in models}}) if models else (),
            typed=True,
            empty=phrase("as the scene has it"),
        ),
    ]
    return FormContent(phrase("Participant {code}", code=participant.code), "", [*rows, _BACK])


def _choices(words: Mapping[str, str]) -> list[SettingChoice]:
    return [SettingChoice(value, text) for value, text in words.items()]


def form_content(form: Form, notice: str = "") -> FormContent:
    """Return the page of a form, a row for each item."""
    rows: list[PageButton | Setting] = [_item_row(name, item) for name, item in form.items.items()]
    rows.append(PageButton("keep", phrase("Keep the answers"), main=True))
    return FormContent(form.title, "", [*rows, _BACK], notice=notice)


def _item_row(name: str, item: Item) -> Setting:
    help_ = " · ".join((translated(item.label), *_ends(item)))
    if item.kind == "choice":
        return Setting(name, item.label, help_, [SettingChoice("", "–"), *(SettingChoice(c, c) for c in item.choices)])
    if item.kind == "scale" and item.step and item.low is not None and item.high is not None:
        count = round(min((item.high - item.low) / item.step, _MOST_STEPS + 1))
        values = [f"{item.low + n * item.step:.10g}" for n in range(count + 1)]
        if count <= _MOST_STEPS:
            return Setting(name, item.label, help_, [SettingChoice("", "–"), *(SettingChoice(v, v) for v in values)])
    return Setting(name, item.label, help_, typed=True, empty=phrase("type it here"))


def _ends(item: Item) -> list[str]:
    """Return what the ends of a scale mean, in the present language."""
    ends = (item.low, item.low_label), (item.high, item.high_label)
    return [f"{value:g}: {translated(label)}" for value, label in ends if label and value is not None]


def answers_given(form: Form, values: Mapping[str, str]) -> tuple[dict[str, Answer], str]:
    """Return the answers and "", or {} and the question whose answer is missing or cannot be taken."""
    given = {
        name: values.get(name, "").replace(",", ".") if item.kind in ("number", "scale") else values.get(name, "")
        for name, item in form.items.items()
    }
    for name, item in form.items.items():
        try:
            check_answers(Form(form.title, {name: item}), {name: given[name]})
        except UsageError:
            return {}, phrase("An answer is missing or cannot be taken: {question}", question=item.label)
    return check_answers(form, given), ""


def earlier_content(study: StudyFolder, participant: Participant) -> tuple[FormContent, dict[str, Path]]:
    """Return the page of the earlier runs of a participant, newest first, and their run folders by the rows' names."""
    rows: list[PageButton] = []
    folders: dict[str, Path] = {}
    for session in reversed(study.sessions_of(participant)):
        planned = {each.number: each.condition for each in study.plan(participant, session)}
        for attempt in reversed(study.attempts(participant, session)):
            if attempt.folder is not None:
                name = f"run {len(rows)}"
                title = title_of(study, planned.get(attempt.run, CALIBRATION))
                rows.append(PageButton(name, title, _attempt_words(session, attempt)))
                folders[name] = attempt.folder
    lines = [] if rows else [phrase("Nothing was played yet.")]
    title = phrase("Participant {code}", code=participant.code)
    return FormContent(title, phrase("Earlier sessions"), [*rows, _BACK], lines=lines), folders


def _attempt_words(session: int, attempt: Attempt) -> str:
    went = {"done": phrase("done"), "interrupted": phrase("interrupted"), "abandoned": phrase("left out")}
    return f"{_session(session)} · {went[attempt.outcome]}"


def _session(number: int) -> str:
    return phrase("session {session:d}", session=number)


def _results(study: StudyFolder, participant: Participant) -> list[Curve]:
    """Return points and time of each condition over the runs, of finished trials."""
    found: dict[tuple[str, str], dict[tuple[int, int], list[float]]] = {}
    for row in trials_of(study, [participant]):
        if row.get("outcome") != FINISHED or row.get("practice"):
            continue
        for measure in ("score", "time_s"):
            if row["condition"] != CALIBRATION and (value := number(row.get(measure))) is not None:
                runs = found.setdefault((row["condition"], measure), {})
                runs.setdefault((row["session"], row["run"]), []).append(value)
    return [
        Curve(
            phrase("{title}: points", title=title_of(study, condition))
            if measure == "score"
            else phrase("{title}: time", title=title_of(study, condition)),
            "" if measure == "score" else "s",
            [sum(values) / len(values) for _, values in sorted(runs.items())],
            [_session(session) for session, _ in sorted(runs)],
        )
        for (condition, measure), runs in found.items()
    ]


def _calibrations(study: StudyFolder, participant: Participant) -> dict[str, list[Curve]]:
    """Return each measure of the calibrations over the times, by group."""
    kept = study.calibrations_of(participant)
    found: dict[str, list[Curve]] = {}
    for group, names in _MEASURES.items():
        found[group] = []
        for name in names:
            times = [(session, each.measures[name]) for session, each in kept if name in each.measures]
            if times:
                metres = times[0][1].unit == "m"
                values = [measure.value * (100.0 if metres else 1.0) for _, measure in times]
                unit = "cm" if metres else times[0][1].unit
                found[group].append(
                    Curve(MEASURE_TITLES[name], unit, values, [_session(session) for session, _ in times])
                )
    return found


def _answers(study: StudyFolder, participant: Participant) -> list[Curve]:
    """Return each item that is answered with a number, and varies, over the times."""
    found: dict[tuple[str, str], list[tuple[int, float]]] = {}
    for line in study.answers_of(participant):
        for item, value in line["answers"].items():
            if (answered := number(value)) is not None:
                found.setdefault((line["form"], item), []).append((line["session"], answered))
    curves = []
    for (form, item), times in found.items():
        known = study.protocol.forms.get(form)
        if known is not None and item in known.items and known.items[item].kind == "scale":
            values = [value for _, value in times]
            curves.append(Curve(known.items[item].label, "", values, [_session(session) for session, _ in times]))
    return curves


def fault_words(error: MimicsError | OSError) -> str:
    """Return what is wrong in the present language: the file, what is wrong with it, and what to do."""
    if not isinstance(error, MimicsError):
        return first_line(error)
    issue = error.issues[0]
    words = "; ".join(translated(each) for each in (issue.what, issue.fix) if each)
    return f"{issue.file}: {words}" if issue.file else words
