"""The participants' pages of the launcher, page by page, until the person goes back or closes the window."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from mimics_app.app.play.journey import play_words, run_words
from mimics_app.app.play.journey_window import JourneyWindow
from mimics_app.app.play.launching import player_of, refusals, settings_of_choice
from mimics_app.app.scenes.shipped import find_shipped
from mimics_app.app.study.own_bodies import why_no_model
from mimics_app.app.study.people_pages import (
    ADD,
    BACK,
    CURVES,
    PERSON,
    STUDY,
    Person,
    answers_given,
    earlier_content,
    fault_words,
    form_content,
    list_content,
    person_content,
    settings_content,
)
from mimics_app.app.study.studies import studies_in, usual_study
from mimics_app.app.study.study_export import write_participant_page
from mimics_app.app.study.study_folder import Participant, StudyFolder
from mimics_app.app.study.study_runs import CALIBRATION, Answer, calibrate, find_next, play_next
from mimics_app.app.terminal.participant import canonical_code, why_no_code
from mimics_app.contracts.clock import FRAME_NS, MonotonicClock
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.system.language import speaking, spoken
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.visual.launcher.form_page import FormContent, FormPage
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice

__all__ = ["show_people"]

_LEAVES = (BACK, "leave")
_PAGE = "participant.html"


def show_people(window: JourneyWindow, choice: LauncherChoice) -> None:
    """Show the participants of the studies in this folder, and play their sessions, until the person leaves.

    Args:
        window: The window; closed by the person, see `JourneyWindow.closed`, nothing more is shown.
        choice: The settings of the launcher with which sessions are played.
    """
    _People(window, choice).show()


class _Closed(Exception):
    """The person closed the window."""


class _People:
    def __init__(self, window: JourneyWindow, choice: LauncherChoice) -> None:
        self._window, self._choice = window, choice
        self._notice, self._closed = "", False

    def show(self) -> None:
        try:
            self._show_list()
        except _Closed:
            return

    def _show_list(self) -> None:
        folder, row = "", ""
        while True:
            studies = studies_in(Path())
            place = next((each for each in studies if str(each) == folder), next(iter(studies), None))
            study, content = self._listed(studies, place)
            chosen, values = self._ask(content, {ADD: "", STUDY: str(place or "")}, row, at_once=STUDY)
            moved, folder = values[STUDY] != str(place or ""), values[STUDY]
            if chosen in _LEAVES:
                return
            if chosen == STUDY or moved:
                continue
            with self._noticing():
                if chosen == ADD:
                    study, code = self._added(study, place, values[ADD])
                else:
                    code = chosen.removeprefix(PERSON)
                row = f"{PERSON}{code}"
                if study is not None and code:
                    self._show_person(study, code)

    def _listed(self, studies: Sequence[Path], place: Path | None) -> tuple[StudyFolder | None, FormContent]:
        """Return the study of a folder and its list; None, with why as a notice, for one that is damaged."""
        try:
            study = None if place is None else StudyFolder(place)
            return study, list_content(studies, study, self._take_notice())
        except (MimicsError, OSError) as error:
            return None, list_content(studies, None, fault_words(error))

    def _added(self, study: StudyFolder | None, place: Path | None, typed: str) -> tuple[StudyFolder | None, str]:
        """Add a participant, and a study where there is none; return both, the code "" where the text is none.

        Raises:
            MimicsError: The study at the place is damaged, or cannot be made.
        """
        code = canonical_code(typed)
        self._notice = why_no_code(code) or ("" if code else phrase("a participant has a code, such as P07"))
        if self._notice:
            return study, ""
        found = study or (usual_study(Path()) if place is None else StudyFolder(place))
        found.find_or_add(code)
        return found, code

    @contextmanager
    def _noticing(self) -> Iterator[None]:
        """Say what goes wrong with a file on the next page: nothing of a study ends the launcher."""
        try:
            yield
        except (MimicsError, OSError) as error:
            self._notice = fault_words(error)

    def _show_person(self, study: StudyFolder, code: str) -> None:
        group, focus = "", ""
        while True:
            person = Person(study, study.find(code))
            notice = self._take_notice()
            group = group if group in person.curves else next(iter(person.curves), "")
            shown = partial(person_content, person, player=self._player, notice=notice)
            chosen, values = self._ask(shown(group), {CURVES: group, "note": ""}, focus, shown)
            group, focus = values[CURVES], chosen
            if chosen in _LEAVES:
                return
            with self._noticing():
                self._do(person, chosen, values)
            if chosen in ("play", "resume", "restart", "abandon", "calibrate"):
                focus = ""

    def _do(self, person: Person, chosen: str, values: Mapping[str, str]) -> None:
        study, participant = person.study, person.participant
        name, _, form = chosen.partition(" ")
        if name == "form":
            self._show_form(study, participant, form)
        elif name == "note" and values["note"].strip():
            study.write_note(participant, person.found.session, values["note"].strip())
        elif name == "earlier":
            self._show_earlier(study, participant)
        elif name == "report":
            self._open_report(study, participant)
        elif name == "settings":
            self._show_settings(study, participant)
        elif name == "calibrate":
            self._play(Path(CALIBRATION), lambda extra, play: calibrate(study, participant, extra, play), participant)
        elif person.scene is not None:
            answer: Answer = "" if name == "play" else name  # type: ignore[assignment]
            deed = lambda extra, play: play_next(study, participant, answer, extra, play)  # noqa: E731
            self._play(person.scene, deed, participant, played=name != "abandon")

    def _play(
        self,
        scene: Path,
        deed: Callable[[Sequence[str], Callable[[Sequence[str]], int]], object],
        participant: Participant,
        *,
        played: bool = True,
    ) -> None:
        """Play a session with the settings of the launcher, in the participant's language."""
        shipped, device = find_shipped(scene.stem), self._choice.settings.get("device", "")
        self._notice = "" if shipped is None or not played else refusals(shipped).get(("device", device), "")
        if self._notice:
            return
        self._window.title = scene.stem if shipped is None else shipped.title
        settings = replace(
            settings_of_choice(self._choice),
            scene=scene,
            participant="",
            language="" if participant.language else spoken(),
            difficulty="usual",
            trials=0,
            side="right",
            larger_text=False,
            high_contrast=False,
        )
        extra = run_words(settings)[1:]

        def play(words: Sequence[str]) -> int:
            ended = play_words(words, self._window)
            self._notice = ended.error
            self._closed = ended.following == "close" or self._window.closed
            return ended.code

        with self._noticing(), speaking(participant.language or spoken()):
            deed(extra, play)
        if self._closed:
            raise _Closed

    def _show_form(self, study: StudyFolder, participant: Participant, name: str) -> None:
        form = study.protocol.forms[name]
        given: Mapping[str, str] = {}
        focus, notice = "", ""
        while True:
            with speaking(participant.language or spoken()):
                content = form_content(form, notice)
                chosen, given = self._ask(content, {**dict.fromkeys(form.items, ""), **given}, focus)
            if chosen in _LEAVES:
                return
            answers, notice = answers_given(form, given)
            if not notice:
                study.write_answers(participant, name, find_next(study, participant).session, answers)
                return
            focus = chosen

    def _show_settings(self, study: StudyFolder, participant: Participant) -> None:
        names = ("language", "side", "text", "contrast", "avatar")
        content = settings_content(study, participant)
        _, values = self._ask(content, {name: getattr(participant, name) for name in names})
        given = {name: values[name].strip() for name in names}
        chosen = {name: value for name, value in given.items() if value != getattr(participant, name)}
        changed = study.with_settings(participant, **chosen)
        self._notice = why_no_model(study, changed)

    def _show_earlier(self, study: StudyFolder, participant: Participant) -> None:
        focus = ""
        while True:
            content, folders = earlier_content(study, participant)
            focus, _ = self._ask(content, {}, focus)
            if focus in _LEAVES:
                return
            with speaking(participant.language or spoken()):
                if self._window.result(folders[focus]) == "close":
                    raise _Closed

    def _open_report(self, study: StudyFolder, participant: Participant) -> None:
        file = study.folder_of(participant) / _PAGE
        with speaking(participant.language or spoken()):
            write_participant_page(study, participant, file)
        opened = webbrowser.open(file.resolve().as_uri())
        words = phrase("The report opens in the browser; if it does not, open {file}", file=file.resolve())
        self._notice = words if opened else phrase("No browser was found; open {file}", file=file.resolve())

    @property
    def _player(self) -> str:
        return player_of(self._choice.settings.get("device", ""))

    def _take_notice(self) -> str:
        notice, self._notice = self._notice, ""
        return notice

    def _ask(
        self,
        content: FormContent,
        values: Mapping[str, str],
        focus: str = "",
        shown: Callable[[str], FormContent] | None = None,
        at_once: str = "",
    ) -> tuple[str, dict[str, str]]:
        """Show a page until something is chosen, and return that and the values.

        The setting `at_once` is chosen where it is changed; a group of curves is shown, by `shown`.
        """
        surface, clock = self._window.surface, MonotonicClock()
        page = FormPage(surface, content, values, focus)
        surface.poll()  # discard keys that were pressed before the page was visible
        try:
            while not surface.should_close:
                before = dict(page.values)
                page.handle(surface.poll())
                if page.chosen:
                    break
                if at_once and page.values[at_once] != before[at_once]:
                    return at_once, page.values
                if shown is not None and page.values[CURVES] != before[CURVES]:
                    page.content = shown(page.values[CURVES])
                page.draw()
                surface.swap()
                clock.sleep_until_ns(clock.now_ns() + FRAME_NS // 2)
            if page.chosen in ("", "close"):
                raise _Closed
            return page.chosen, page.values
        finally:
            page.release()
