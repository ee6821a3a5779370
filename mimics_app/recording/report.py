"""The report of a run: one self-contained HTML file, also of a run that was cut off.

This module gathers its content as plain values, tables and plots; `templates/report.html.j2` is the page.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages.report_section import ReportSection
from mimics_app.contracts.messages.trial_counts import COUNTED_TRIALS, count_trials
from mimics_app.contracts.system.language import LANGUAGES, SOURCE, speaking, spoken, translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.page_templates import load_templates
from mimics_app.plotting.plot import Plot
from mimics_app.recording.attempts import Attempt, find_attempts
from mimics_app.recording.columns import row_norms
from mimics_app.recording.json_text import indented_json
from mimics_app.recording.orthosis_residual import residual_torques
from mimics_app.recording.report_figures import draw_path, draw_states, draw_traces
from mimics_app.recording.report_front import Front, front_of
from mimics_app.recording.report_gait import draw_gait
from mimics_app.recording.report_person import Person, person_of
from mimics_app.recording.report_real_time import RealTime, late_card, real_time_of
from mimics_app.recording.report_stability import smallest_margin, stability_tables
from mimics_app.recording.report_tables import (
    Contacts,
    Table,
    Trials,
    contacts_of,
    governor_tables,
    key_table,
    lines_table,
    loss_table,
    plan_tables,
    state_table,
    trials_of,
    trip_table,
)
from mimics_app.recording.report_values import NONE, Seconds, mapping, number, one, scaled, shown
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES, write_atomically
from mimics_app.recording.session_totals import session_totals
from mimics_app.recording.trip_log import FOLDER, complete_trips, read_trip
from mimics_app.recording.trips import TripReader
from mimics_app.recording.verdict import evaluate

__all__ = ["Page", "page_of", "write_report"]

MOST_DRAWN = 8
"""Largest number of trips plotted; the others are in their files."""


@dataclass(frozen=True, slots=True)
class Trip:
    """The second before a trip: time of the trip [s], name of its file, plots ([] without rows)."""

    at_s: Seconds
    file: str
    plots: list[Plot]


def trips_of(run: Run) -> list[Trip]:
    """Return the first trips of a run with their plots."""
    return [_trip(run, tick, path) for tick, path in complete_trips(run)[:MOST_DRAWN]]


def _trip(run: Run, tick: int, path: Path) -> Trip:
    samples = read_trip(path)
    plots = [_forces(samples), _speeds(samples)] if len(samples) > 1 else []
    return Trip(Seconds(run.seconds(tick)), f"{FOLDER}/{path.name}", plots)


def _before(samples: NDArray[Any]) -> NDArray[np.float64]:
    """Return the time relative to the last row [ms], <= 0."""
    return np.asarray(1e3 * (samples["t"] - samples["t"][-1]), np.float64)


def _forces(samples: NDArray[Any]) -> Plot:
    when, rendered = _before(samples), row_norms(samples["f_user_world"])
    wanted, measured = row_norms(samples["f_virt_world"]), row_norms(samples["f_meas"])
    x, y = (
        Axis.of("before the trip [ms]", when, margin=0.0),
        Axis.of("force [N]", rendered, wanted, measured, zero=True),
    )
    plot = Plot(x, y, "Forces before the trip", height=170.0)
    plot.line(when, measured, "measured", "of the person on the handle")
    plot.line(when, wanted, "wall", "virtual")
    plot.line(when, rendered, "rendered", "virtual, as rendered")
    return plot


def _speeds(samples: NDArray[Any]) -> Plot:
    when, speed = _before(samples), row_norms(samples["v_world"])
    step = np.append(0.0, row_norms(np.diff(samples["hip_world"], axis=0)) / np.diff(samples["t"]))
    x, y = Axis.of("before the trip [ms]", when, margin=0.0), Axis.of("speed [m/s]", speed, step, zero=True)
    plot = Plot(x, y, "Speed before the trip", height=150.0)
    plot.line(when, step, "measured", "by the reported positions")
    plot.line(when, speed, "robot", "as reported")
    return plot


_OWN_KEYS = ("format", "version", "versions", "machine", "clock", "plan")
_TEMPLATES = Path(__file__).parent / "templates"
_BADGES = {
    "clean": phrase("recording complete"),
    "open": phrase("recording not closed"),
    "interrupted": phrase("recording interrupted"),
    "recovered": phrase("recording recovered"),
}
_UNREADABLE = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
"""Errors of a section on facts of a scene that are damaged or of another shape."""


@dataclass(frozen=True, slots=True)
class Movement:
    """One attempt.

    Attributes:
        anchor: Its place on the page; a link to it unfolds it.
        name: Its name in the list of attempts.
        title: Name, condition and result.
        path: Path in the frontal plane; None: the hand rested.
        traces: Force and velocity over time.
        open: Whether it is unfolded when the page is opened.
    """

    anchor: str
    name: str
    title: str
    path: Plot | None
    traces: list[Plot]
    open: bool


@dataclass(frozen=True, slots=True)
class Safety:
    """Figures by name, unusual limits, softened contacts, states, walk, trips, losses, what led to trips, stability."""

    cards: dict[str, str]
    words: str
    limits: list[str]
    softened: list[str]
    states: Plot
    walk: list[Plot]
    trips: Table | None
    losses: Table | None
    changes: Table | None
    drawn: list[Trip]
    more_drawn: bool
    stability: dict[str, Table]


@dataclass(frozen=True, slots=True)
class Settings:
    """Tables by heading, the dump of everything that was set, and the scene as text ("" for none)."""

    tables: dict[str, Table]
    everything: Table | None
    scene: str


@dataclass(frozen=True, slots=True)
class Record:
    """Environment of the run, its files with their seals, and its state hash ("" for none)."""

    made: Table | None
    files: Table | None
    state_hash: str


@dataclass(frozen=True, slots=True)
class Page:
    """Content of a report.

    Attributes:
        title, status, tone: Head; `tone` is the class of the status in the style sheet.
        line: Participant, time, duration, device and seed in words.
        problems: Problems of the recording, one sentence each.
        cards: Figures of the run by name.
        counted: Trials these figures are over, as in the summary of the task; "" for none.
        front: Content of page one.
        anchors: Place of the movement of each of its trials.
        trials: None where none ended.
        heading, colours: Of the movement.
        movement: Movement of each attempt.
        person: Body signals and adaptation; None without body signals.
        contacts: None where nothing was touched.
        safety, real_time: None where no tick was recorded.
        picture: Tables of the frame governor by heading.
        settings, record: What the run was made with and what it left.
    """

    title: str
    status: str
    tone: str
    line: list[str]
    problems: list[str]
    cards: dict[str, str]
    counted: str
    front: Front
    anchors: list[str]
    trials: Trials | None
    heading: str
    colours: str
    movement: list[Movement]
    person: Person | None
    contacts: Contacts | None
    safety: Safety | None
    real_time: RealTime | None
    picture: dict[str, Table]
    settings: Settings
    record: Record


def write_report(folder: Path, sections: Sequence[ReportSection]) -> Path:
    """Write report.html into a run folder and return where it is.

    Args:
        folder: The run folder.
        sections: Sections of the kinds of task; the first that takes the run describes its movement.

    Raises:
        SceneError: It is not a run folder.
        OSError: The folder cannot be written.
    """
    run = Run.open(folder)
    with speaking(_language_of(run)):
        page = _render(page_of(run, sections))
    path = folder / FILES["report"]
    write_atomically(path, page.encode())
    return path


def _language_of(run: Run) -> str:
    """Return the language of the session, in which the report is written; English where the run states none."""
    language = str(mapping(run.session.get("settings")).get("language", ""))
    return language if language in LANGUAGES else SOURCE


def _render(page: Page) -> str:
    """Return a report as HTML, with automatic escaping; characters that UTF-8 cannot encode become question marks."""
    templates = load_templates(_TEMPLATES, shown=shown)
    text = templates.get_template("report.html.j2").render(page=page, language=spoken(), translated=translated)
    return text.encode("utf-8", "replace").decode()


def page_of(run: Run, sections: Sequence[ReportSection]) -> Page:
    """Return the content of a run's report; `sections` as in `write_report`."""
    attempts = find_attempts(run)
    facts = mapping(run.session.get("facts"))
    section = _section_of(sections, facts, attempts)
    recorded, first = len(run.haptic) > 0, _first_shown(attempts)
    return Page(
        title=translated(phrase("Report of {scene}", scene=_scene_name(run))),
        status=translated(_BADGES.get(run.status, run.status)),
        tone={"clean": "good", "open": "bad"}.get(run.status, "warn"),
        line=_head_line(run),
        problems=list(evaluate(run).problems),
        cards={
            translated(name): translated(text) for name, text in _cards(run, attempts, section).items() if text != NONE
        },
        counted=str(task.get("counted", COUNTED_TRIALS)) if (task := session_totals(run.summary, run.trials)) else "",
        front=front_of(run),
        anchors=[attempt.anchor for attempt in attempts if attempt.row],
        trials=trials_of(run),
        heading=section.heading if attempts else phrase("Movement"),
        colours=section.colours if attempts else "",
        movement=[_movement(run, attempt, (section, facts), opened=attempt is first) for attempt in attempts],
        person=_person(run),
        contacts=contacts_of(run),
        safety=_safety(run) if recorded else None,
        real_time=real_time_of(run) if recorded else None,
        picture=governor_tables(run),
        settings=_settings(run),
        record=_record(run),
    )


def _first_shown(attempts: list[Attempt]) -> Attempt | None:
    """Return the attempt that is unfolded on the page: the first that is not practice."""
    counting = [attempt for attempt in attempts if not attempt.row.get("practice")]
    return next(iter([*counting, *attempts]), None)


def _scene_name(run: Run) -> str:
    scene = run.session.get("scene", "a run")
    title = mapping(scene).get("title")
    if isinstance(title, str) and title.strip():
        return title
    return shown(scene.get("name", "a run") if isinstance(scene, Mapping) else scene).replace("_", " ")


def _head_line(run: Run) -> list[str]:
    seconds = float(run.haptic["t"][-1]) if len(run.haptic) else 0.0
    known = {**mapping(run.session.get("settings")), **run.session}
    code = shown(known.get("participant", ""))
    whose = [translated(phrase("participant {code}", code=code))] if code else []
    words = [*whose, _local_time(mapping(run.session.get("clock")).get("utc")), translated(f"{seconds:.1f} s")]
    moved_by = mapping(run.session.get("moved_by"))
    if moved_by.get("person") == "simulated":
        words.append(translated(phrase("simulated patient, {preset:s}", preset=shown(moved_by.get("preset")))))
    words += [shown(known[key]) for key in ("device", "profile") if known.get(key)]
    words.append(f"seed {shown(run.session.get('seed'))}")
    return [word for word in words if word]


def _local_time(utc: object) -> str:
    """Return a time in the time zone of this computer, with its name; "" for none."""
    try:
        return datetime.fromisoformat(str(utc)).astimezone().strftime("%Y-%m-%d %H:%M %Z")
    except (ValueError, OverflowError):
        return ""


def _cards(run: Run, attempts: list[Attempt], section: ReportSection) -> dict[str, str]:
    task = session_totals(run.summary, run.trials)
    forces = [_largest_force(attempt) for attempt in attempts]
    return {
        **_trial_cards(run),
        phrase("score of 100"): _points(task.get("score")),
        phrase("mean time of a trial"): one(task.get("time_s"), "s"),
        **{name: _card(*figure) for name, figure in section.tiles(task).items()},
        section.path_error: one(scaled(task.get("path_error_m"), 1000.0), "mm"),
        section.contacts: shown(task.get("contacts")),
        phrase("largest force felt"): one(float(max(forces, default=0.0)) or None, "N"),
        **_resistance(run),
        phrase("safety stops"): shown(_stops_and_holds(run)["safety stops"]),
    }


def _resistance(run: Run) -> dict[str, str]:
    """Return what an orthosis leaves of its resistance to legs that swing freely; {} for any other run."""
    names = {"hip": phrase("orthosis resists at the hips"), "knee": phrase("orthosis resists at the knees")}
    rms = residual_torques(run)
    return {names[joint]: f"{max(rms[joint]):.1f} N m" for joint in rms}


def _largest_force(attempt: Attempt) -> float:
    """Return the largest force felt in an attempt [N]: that of its row, where that is of every tick."""
    peak = number(attempt.row.get("force_peak_n")) if "happened" in attempt.row or "lost" in attempt.row else None
    samples = attempt.samples[attempt.free]["f_user_world"]
    return float(row_norms(samples).max(initial=0.0)) if peak is None else peak


def _points(score: object) -> str:
    """Return a score in whole points."""
    value = number(score)
    return NONE if value is None else f"{value:.0f}"


def _operators_cards(run: Run) -> dict[str, str]:
    """Return the figures of the machine, apart from those of the person."""
    return {
        phrase("smallest stability margin"): one(scaled(smallest_margin(run.haptic), 100.0), "%"),
        **late_card(run),
        phrase("short holds"): shown(_stops_and_holds(run)["short holds"]),
    }


def _trial_cards(run: Run) -> dict[str, str]:
    """Return the number of finished trials and practice, each only if some ended."""
    counts = count_trials(run.trials)
    ended = {
        phrase("trials finished"): (counts.completed, counts.trials),
        phrase("practice finished"): (counts.practice_completed, counts.practice_trials),
    }
    cards = {
        name: phrase("{number:d} of {trials:d}", number=completed, trials=trials)
        for name, (completed, trials) in ended.items()
        if trials
    }
    planned = _planned(run)
    if planned > counts.trials > 0:
        cards["trials finished"] = phrase(
            "{number:d} of {trials:d}, {planned:d} planned",
            number=counts.completed,
            trials=counts.trials,
            planned=planned,
        )
    return cards


def _planned(run: Run) -> int:
    """Return the number of trials that the recorded task plans, without practice; 0 where it does not say."""
    blocks = mapping(mapping(run.session.get("task")).get("spec")).get("trials")
    counts = [mapping(block) for block in blocks] if isinstance(blocks, list) else []
    return sum(
        len(block["trials"]) * int(number(block.get("repetitions")) or 1)
        for block in counts
        if not block.get("practice") and isinstance(block.get("trials"), list)
    )


def _stops_and_holds(run: Run) -> dict[str, int]:
    """Return the number of latched stops, and of short holds after late ticks."""
    latched = [trip.latched for trip in TripReader().take(run.events)]
    return {"safety stops": sum(latched), "short holds": len(latched) - sum(latched)}


def _card(figure: object, unit: str) -> str:
    return one(figure, unit) if unit else shown(figure)


def _section_of(sections: Sequence[ReportSection], facts: Mapping[str, Any], attempts: list[Attempt]) -> ReportSection:
    """Return the first section that takes the run, else the plain one."""
    return next((section for section in sections if section.takes(facts, attempts)), ReportSection())


def _movement(run: Run, attempt: Attempt, taken: tuple[ReportSection, Mapping[str, Any]], *, opened: bool) -> Movement:
    """Return path and traces of an attempt, without the section's additions where it cannot read the facts."""
    section, facts = taken
    try:
        path, traces = draw_path(section, attempt, facts, run.events), draw_traces(section, attempt, facts)
    except _UNREADABLE:
        plain = ReportSection()
        path, traces = draw_path(plain, attempt, facts, run.events), draw_traces(plain, attempt, facts)
    return Movement(attempt.anchor, attempt.heading, attempt.title, path, traces, opened)


def _person(run: Run) -> Person | None:
    """Return body signals and adaptation; None without, or where their lines are damaged."""
    try:
        return person_of(run)
    except _UNREADABLE:
        return None


def _safety(run: Run) -> Safety:
    beyond, softened = (run.session.get(name) for name in ("beyond_usual_limits", "softened"))
    counts = _stops_and_holds(run)
    return Safety(
        cards={name: text for name, text in _operators_cards(run).items() if text != NONE},
        words=phrase(
            "Safety stops: {stops:d}; short holds: {holds:d}. A stop is latched until a person resets it; a short "
            "hold, after a late tick, ends on its own.",
            stops=counts["safety stops"],
            holds=counts["short holds"],
        ),
        limits=[shown(line) for line in beyond] if isinstance(beyond, list) else [],
        softened=[shown(line) for line in softened] if isinstance(softened, list) else [],
        states=draw_states(run.haptic),
        walk=draw_gait(run.haptic, run.layout.extent),
        trips=trip_table(run),
        losses=loss_table(run),
        changes=state_table(run),
        drawn=trips_of(run),
        more_drawn=sum(counts.values()) > MOST_DRAWN,
        stability=stability_tables(run),
    )


def _settings(run: Run) -> Settings:
    own = {key: item for key, item in run.session.items() if key not in _OWN_KEYS}
    scene = mapping(own.get("scene"))
    document = scene.get("document")
    if document is not None:
        own["scene"] = {key: item for key, item in scene.items() if key != "document"}
    tables = plan_tables(run.session.get("plan"))
    for title, kind in (("Sound", "audio"), ("Picture as it was opened", "quality")):
        for line in run.lines_of("app", kind)[-1:]:
            tables[title] = key_table({key: item for key, item in line.items() if key not in ("source", "kind")})
    if actions := run.lines_of("app", "action"):
        tables["Adaptations"] = lines_table(actions)
    text = "" if document is None else indented_json(document)
    return Settings(tables, key_table(own) if own else None, text)


def _record(run: Run) -> Record:
    made: dict[str, Any] = {key: run.session[key] for key in ("machine", "versions") if key in run.session}
    if run.manifest is None:
        return Record(key_table(made) if made else None, None, "")
    rows = [(name, sealed.bytes, sealed.sha256) for name, sealed in run.manifest.files.items()]
    files = Table(["file", "bytes", "SHA-256"], rows, "keys")
    return Record(key_table(made) if made else None, files, run.manifest.state_hash)
