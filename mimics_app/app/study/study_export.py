"""Export of a study: tidy tables, a page for the study and one for each participant, readable without a network."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.study.change import Interval
from mimics_app.app.study.study_folder import Participant, StudyFolder, folder_name
from mimics_app.app.study.study_results import Change, Effect, changes_of, effects_of, measures_in, title_of, trials_of
from mimics_app.app.study.study_runs import CALIBRATION
from mimics_app.app.study.tables import write_table
from mimics_app.contracts.errors import OutputError
from mimics_app.contracts.messages.calibration_record import MEASURE_TITLES
from mimics_app.contracts.system.language import speaking, spoken, translated
from mimics_app.contracts.system.phrases import counted_phrase, phrase
from mimics_app.contracts.system.whole_file import private_text
from mimics_app.plotting.page_templates import load_templates
from mimics_app.recording.history import local_time
from mimics_app.recording.result_words import has_caption, mean_words, measure_caption
from mimics_app.recording.run_folder import PRIVATE_FOLDER

__all__ = ["export_study", "write_participant_page"]

_ANSWER = ["participant", "form", "session", "time", "item", "label", "value", "utc"]
_CALIBRATED = ["participant", "session", "time", "measure", "value", "unit", "repeats", "spread", "at_least", "utc"]
_FEW_DIGITS = 10.0
"""Value of a measure from which it has one digit after the point."""
_BEGIN = ["participant", "session", "run", "attempt", "condition"]


@dataclass(frozen=True, slots=True)
class _About:
    """What is known of one participant.

    Attributes:
        changes: Changes of the measures.
        answers, calibrations: Rows of the tables, in order.
        notes: Lines of notes.
    """

    changes: Sequence[Change] = ()
    answers: Sequence[Mapping[str, object]] = ()
    calibrations: Sequence[Mapping[str, object]] = ()
    notes: Sequence[Mapping[str, object]] = ()


def export_study(study: StudyFolder, folder: Path) -> list[Path]:
    """Write the tables as CSV, study.html, and a page for each participant, in that person's language if there is one.

    Raises:
        OutputError: The folder has files already.
    """
    if folder.exists() and any(folder.iterdir()):
        raise OutputError(folder, "this folder is not empty", "name another one")
    folder.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)
    trials = trials_of(study)
    measures = measures_in(trials)
    effects = effects_of(trials, list(measures))
    by_person = {each: [row for row in trials if row["participant"] == each.code] for each in study.participants}
    changes = {each: changes_of(rows, list(measures)) for each, rows in by_person.items()}
    names = [*_BEGIN, *dict.fromkeys(name for row in trials for name in row if name not in _BEGIN)]
    write_table(folder / "trials.csv", trials, names)
    lines = [_change_row(person, change) for person, found in changes.items() for change in found]
    write_table(folder / "changes.csv", lines)
    write_table(folder / "effects.csv", [_effect_row(effect) for effect in effects])
    answers = {each: list(_answer_rows(study, each)) for each in study.participants}
    if study.protocol.forms:
        write_table(folder / "answers.csv", [row for rows in answers.values() for row in rows], _ANSWER)
    trends = {each: list(_calibration_rows(study, each)) for each in study.participants}
    calibrated = any(trends.values())
    if calibrated:
        write_table(folder / "calibrations.csv", [row for rows in trends.values() for row in rows], _CALIBRATED)
    pages = {each: f"participant_{folder_name(each.code)}.html" for each in study.participants}
    optional = {"answers": bool(study.protocol.forms), "calibrations": calibrated}
    kept = [
        f"{name}.csv" for name in ("trials", "changes", "effects", *(each for each, there in optional.items() if there))
    ]
    _write_page(folder / "study.html", study, "", measures, effects=effects, pages=pages, files=kept)
    for person, name in pages.items():
        about = _About(changes[person], answers[person], trends[person], study.notes_of(person))
        with speaking(person.language or spoken()):
            _write_page(folder / name, study, person.code, measures, about=about)
    return [folder / name for name in (*kept, "study.html", *pages.values())]


def write_participant_page(study: StudyFolder, person: Participant, file: Path) -> None:
    """Write the page of one participant, in place of an older one."""
    trials = [row for row in trials_of(study, [person]) if row["condition"] != CALIBRATION]  # it has a table of its own
    measures = measures_in(trials)
    _write_page(
        file,
        study,
        person.code,
        measures,
        about=_About(
            changes_of(trials, list(measures)),
            list(_answer_rows(study, person)),
            list(_calibration_rows(study, person)),
            study.notes_of(person),
        ),
    )


def _answer_rows(study: StudyFolder, person: Participant) -> Iterator[dict[str, Any]]:
    """Yield a row for each answer of a participant, in order."""
    times: Counter[str] = Counter()
    for line in study.answers_of(person):
        name, form = line["form"], study.protocol.forms.get(line["form"])
        times[name] += 1
        whose = {"participant": person.code, "form": name, "session": line["session"], "time": times[name]}
        for item, value in line["answers"].items():
            label = form.items[item].label if form is not None and item in form.items else ""
            yield {**whose, "item": item, "label": label, "value": value, "utc": line["utc"]}


def _calibration_rows(study: StudyFolder, person: Participant) -> Iterator[dict[str, Any]]:
    """Yield a row for each measure of each calibration of a participant, in order."""
    for time, (session, calibration) in enumerate(study.calibrations_of(person), start=1):
        whose = {"participant": person.code, "session": session, "time": time}
        for measure in calibration.measures.values():
            plain = msgspec.structs.asdict(measure)
            yield {**whose, "measure": plain.pop("name"), **plain, "utc": calibration.utc}


def _by_measure(rows: Sequence[Mapping[str, Any]]) -> list[tuple[str, str, str]]:
    """Return measure, unit, and the values over the calibrations, each with its spread."""
    found: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        unit, factor = ("cm", 100.0) if row["unit"] == "m" else (str(row["unit"]), 1.0)
        value, digits = factor * row["value"], 1 if abs(factor * row["value"]) >= _FEW_DIGITS else 2
        text = translated(f"{value:.{digits}f} ± {0.5 * factor * row['spread']:.{digits}f}")
        text = translated(phrase("{measured:s} or more", measured=text)) if row["at_least"] else text
        title = translated(MEASURE_TITLES.get(row["measure"], row["measure"]))
        found.setdefault((title, unit), []).append(text)
    return [(measure, unit, " → ".join(values)) for (measure, unit), values in found.items()]


def _change_row(person: Participant, change: Change) -> dict[str, Any]:
    whose = {"participant": person.code, "condition": change.condition, "measure": change.measure}
    values = {"first": change.means[0].mean, "last": change.means[-1].mean, "runs": len(change.means)}
    interval = change.change
    return {**whose, **values, **({"change": interval.mean, **_bounds(interval)} if interval else {})}


def _effect_row(effect: Effect) -> dict[str, Any]:
    row = {"condition": effect.condition, "measure": effect.measure, **asdict(effect.mean), "against": effect.against}
    if effect.effect is None:
        return row
    return {**row, "effect": effect.effect.mean, **{f"effect_{k}": v for k, v in _bounds(effect.effect).items()}}


def _bounds(interval: Interval) -> dict[str, float | None]:
    return {"low": interval.low, "high": interval.high}


def _write_page(
    file: Path,
    study: StudyFolder,
    participant: str,
    measures: Mapping[str, str],
    *,
    effects: Sequence[Effect] = (),
    about: _About | None = None,
    pages: Mapping[Participant, str] | None = None,
    files: Sequence[str] = (),
) -> None:
    forms = study.protocol.forms
    about = about or _About()
    environment = load_templates(Path(__file__).parent / "templates")
    environment.filters["interval"] = _interval_words
    page = environment.get_template("results.html.j2").render(
        language=spoken(),
        translated=translated,
        value=mean_words,
        title=study.title,
        participant=participant,
        measures=measures,
        captions={name: measure_caption(name) for name in measures},
        effects=effects,
        changes=[each for each in about.changes if has_caption(each.measure)],
        scene_title=lambda condition: translated(title_of(study, condition)),
        answers=[
            (forms[form].title if form in forms else form, label, values)
            for form, label, values in _by_item(about.answers)
        ],
        trends=_by_measure(about.calibrations),
        notes=[(local_time(str(each["utc"])), each["note"]) for each in about.notes],
        pages=[(person.code, name) for person, name in (pages or {}).items()],
        size=translated(counted_phrase("{n:d} participant", "{n:d} participants", len(study.participants))),
        files=files,
    )
    with private_text(file) as stream:
        stream.write(page)


def _by_item(answers: Sequence[Mapping[str, object]]) -> list[tuple[str, str, str]]:
    """Return form, question, and the answers over the times of each item."""
    found: dict[tuple[str, str], list[str]] = {}
    for row in answers:
        value = row["value"]
        text = translated(f"{value:g}" if isinstance(value, float) else str(value))
        found.setdefault((str(row["form"]), str(row["label"] or row["item"])), []).append(text)
    return [(form, label, " → ".join(values)) for (form, label), values in found.items()]


def _interval_words(interval: Interval | None, measure: str) -> str:
    if interval is None:
        return ""
    mean = mean_words(measure, interval.mean)
    if interval.low is None or interval.high is None:
        return mean
    low, high = mean_words(measure, interval.low), mean_words(measure, interval.high)
    return translated(phrase("{mean:s} ({low:s} to {high:s})", mean=mean, low=low, high=high))
