"""Contents of the launcher in a therapist's words: scenes, settings, recent runs, and the last choice."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mimics_app.app.installation.display_files import find_display_files
from mimics_app.app.installation.serial_ports import list_serial_ports
from mimics_app.app.play.operators_page import DEFAULT_PORT, can_serve
from mimics_app.app.scenes.shipped import GROUPS, ShippedScene, find_shipped, shipped_scenes, thumbnail_of
from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.participant import canonical_code, why_no_code
from mimics_app.app.terminal.participant_language import usual_language
from mimics_app.app.terminal.user_files import LAUNCHER, read_config, write_config
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.messages.trial_counts import finished_words, practice_only
from mimics_app.contracts.ports.display_choice import display_names, kind_of_display
from mimics_app.contracts.system.language import LANGUAGES
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.history import EarlierRun, cut_off_runs, local_time, recent_runs
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import (
    BUILT_IN,
    POINTER,
    REPLAY,
    SIMULATED,
    device_names,
    load_built_in,
)
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice, ScenarioCard
from mimics_app.rendering.visual.launcher.setting import Setting, SettingChoice

__all__ = [
    "LANGUAGE",
    "cut_off_notice",
    "last_choice",
    "launcher_cards",
    "launcher_settings",
    "player_of",
    "refusals",
    "remember",
    "settings_of_choice",
    "wants_contrast",
]

LANGUAGE, TEXT = "language", "text"
"""Names of the settings of the language, and of size and contrast of texts."""
_MOST_RECENT = 12
_SIMULATED = tuple(name for name in BUILT_IN if name.startswith("simulated"))


_AT_WINDOW = ""
"""Value of the setting "who plays" for the person at the window."""

_ADDRESSED = tuple(name for name in BUILT_IN if load_built_in(name).address and not load_built_in(name).optional)
"""Devices that need an address."""


def launcher_settings() -> list[Setting]:
    """Return the settings of the launcher, with the devices and displays of this installation."""
    return [*_person_settings(), *_task_settings(), *_output_settings()]


def _players() -> dict[str, str]:
    """Return the captions of the devices: the person at the window first, what needs an address last."""
    others = sorted((name for name in device_names() if name not in (POINTER, REPLAY)), key=_ADDRESSED.__contains__)
    captions = {name: load_built_in(name).caption if name in BUILT_IN else name for name in others}
    return {_AT_WINDOW: load_built_in(POINTER).caption, **captions}


def player_of(device: str) -> str:
    """Return the caption of a device, by the value of its setting."""
    return _players().get(device, device)


def refusals(scene: ShippedScene) -> Mapping[tuple[str, str], str]:
    """Return why a scene cannot be played, by ("device", value): its robot has another shape than the device."""
    if not scene.device:
        return {}
    captions, wanted = _players(), descriptor_of(scene.device)
    fitting = [value for value in captions if _fits(value, wanted) or value.partition(":")[0] in scene.also]
    named = scene.device if scene.device in fitting else next(iter(fitting), scene.device)
    words = phrase(
        "This scene is played with {limb:s}. Choose: {device}", limb=scene.takes, device=captions.get(named, named)
    )
    return {("device", value): words for value in captions if value not in fitting}


def _fits(value: str, wanted: DeviceDescriptor) -> bool:
    """Whether a device has the joints and points of contact that a scene is made for, as far as is known."""
    try:
        there = descriptor_of(value.partition(":")[0] or POINTER)
    except DeviceError:
        return True  # what is wrong with it is said at the start
    return there.extent.joints == wanted.extent.joints and there.contacts == wanted.contacts


def _person_settings() -> list[Setting]:
    """Return the settings of person, device and participant code."""
    return [
        Setting(
            "device",
            phrase("Who plays"),
            phrase("A person at this computer, a robot, or a simulated patient."),
            _choices(_players()),
        ),
        Setting(
            "address",
            phrase("Port or address of the robot"),
            phrase("Of a serial robot e.g. /dev/ttyUSB0; of a HapticMaster its address, e.g. 192.168.0.10."),
            _choices({each["port"]: each["port"] for each in list_serial_ports()}),
            typed=True,
            empty=phrase("type it here"),
            with_values=_ADDRESSED,
        ),
        Setting(
            "patient",
            phrase("Simulated patient"),
            phrase("How much the simulated patient is impaired."),
            _choices(
                {
                    "": phrase("usual for the scene"),
                    "healthy": phrase("healthy"),
                    "moderate": phrase("moderate"),
                    "severe": phrase("severe"),
                }
            ),
            with_values=_SIMULATED,
        ),
        Setting(
            "participant",
            phrase("Participant code"),
            phrase(
                "A code, never a name. Results are compared with earlier ones of this code, and the task is fitted "
                "to its newest calibration."
            ),
            typed=True,
            empty=phrase("no code"),
            refuse=lambda typed: why_no_code(canonical_code(typed)),
        ),
        *_fitting_settings(),
    ]


def _fitting_settings() -> list[Setting]:
    """Return the settings that fit a session to its person."""
    return [
        Setting(
            LANGUAGE,
            phrase("Language"),
            phrase("Language of the person: of this page, of tasks, results and report."),
            _choices(_languages()),
        ),
        Setting(
            TEXT,
            phrase("Text and contrast"),
            phrase(
                "Larger cards and prompts in the session. High contrast: white on black; paths, targets and the hand's "
                "marker in colours that stand out."
            ),
            _choices(
                {
                    "": phrase("usual size"),
                    "larger": phrase("larger"),
                    "contrast": phrase("high contrast"),
                    "both": phrase("larger, in high contrast"),
                }
            ),
        ),
        Setting(
            "side",
            phrase("Side that plays"),
            phrase("Left mirrors the scenes that have a side."),
            _choices({"": phrase("right side"), "left": phrase("left side")}),
        ),
    ]


def _languages() -> dict[str, str]:
    """Return the names of the languages, the usual one first."""
    usual = usual_language()
    return {usual: LANGUAGES[usual], **LANGUAGES}


def _task_settings() -> list[Setting]:
    """Return the settings of difficulty and number of trials."""
    return [
        Setting(
            "difficulty",
            phrase("Difficulty"),
            phrase("Easier: for most scenes wider, softer, and with help of the robot. Harder: narrower and stiffer."),
            _choices({"usual": phrase("usual"), "easier": phrase("easier"), "harder": phrase("harder")}),
        ),
        Setting(
            "trials",
            phrase("Number of trials"),
            phrase("Trials that count. Practice is extra."),
            _choices({"": phrase("usual for the scene"), **{str(n): str(n) for n in (1, 2, 3, 5, 10, 20)}}),
        ),
    ]


def _output_settings() -> list[Setting]:
    """Return the settings of picture and sound."""
    kinds = {name: kind_of_display(name) for name in display_names()}
    captions = {name: kind.caption for name, kind in kinds.items() if kind.file != "must"}
    displays = {"": phrase("usual for the scene"), **captions, **_found_displays()}
    return [
        Setting(
            "profile",
            phrase("Quality"),
            phrase("Usual and fast: a simpler picture where the computer is slow. Study: always the full picture."),
            _choices({"training": phrase("usual"), "draft": phrase("fast"), "study": phrase("study, nothing lowered")}),
        ),
        Setting(
            "sound",
            phrase("Sound"),
            phrase("On plays through this computer; a file is written into the recording."),
            _choices({"auto": phrase("on"), "file": phrase("into a file"), "off": phrase("off")}),
        ),
        Setting(
            "display",
            phrase("Display"),
            phrase("On what the picture is shown."),
            _choices(displays),
        ),
        Setting(
            "console",
            phrase("Operator's page"),
            phrase("Opens in a browser, for the second screen: to watch, pause, stop and adjust the session."),
            _choices({"": phrase("off"), **({"open": phrase("open on the second screen")} if can_serve() else {})}),
        ),
    ]


def _found_displays() -> dict[str, str]:
    """Return the walls and headsets whose files in this folder are right."""
    return {one["write"]: one["write"] for one in find_display_files(Path.cwd()) if not one["error"]}


def settings_of_choice(choice: LauncherChoice) -> RunSettings:
    """Return the person's choice as the settings of a run."""
    chosen = choice.settings
    device = chosen["device"]
    if device in _ADDRESSED:
        device = f"{device}:{chosen['address']}"
    return RunSettings(
        scene=choice.scene,
        device=device,
        patient=chosen["patient"] if chosen["device"] in _SIMULATED else "",
        participant=canonical_code(chosen["participant"]),
        language=chosen.get(LANGUAGE, ""),
        larger_text=chosen.get(TEXT) in ("larger", "both"),
        high_contrast=wants_contrast(chosen),
        side="left" if chosen.get("side") == "left" else "right",
        difficulty=chosen["difficulty"],  # type: ignore[arg-type]
        trials=int(chosen["trials"] or 0),
        profile=chosen["profile"],  # type: ignore[arg-type]
        sound=chosen["sound"],  # type: ignore[arg-type]
        display=chosen["display"],
        console=DEFAULT_PORT if chosen.get("console") else None,
    )


def wants_contrast(chosen: Mapping[str, str]) -> bool:
    """Whether the values of the settings ask for high contrast."""
    return chosen.get(TEXT) in ("contrast", "both")


def launcher_cards(runs: Path) -> list[ScenarioCard]:
    """Return one card per shipped scene with the last score of a person, and one per recent session."""
    recent = recent_runs(runs, _MOST_RECENT)
    newest = {run.scene: run for run in reversed(recent) if not run.simulated and run.score is not None}
    cards = [_card(scene, newest.get(scene.name)) for scene in shipped_scenes()]
    return cards + [card for run in recent if (card := _recent_card(run)) is not None]


def cut_off_notice(runs: Path) -> str:
    """Return advice on sessions that were cut off; "" where there is none."""
    left = cut_off_runs(runs)
    if not left:
        return ""
    if len(left) == 1:
        return phrase(
            "A session was cut off; this repairs its recording: mimics record recover {folder}", folder=left[0]
        )
    return phrase(
        "A session (and {more:d} before it) was cut off; this repairs its recording: mimics record recover {folder}",
        more=len(left) - 1,
        folder=left[0],
    )


def remember(choice: LauncherChoice) -> None:
    """Keep the choice for the next start."""
    write_config(LAUNCHER, {"scene": choice.scene.stem, "settings": choice.settings})


def last_choice() -> LauncherChoice | None:
    """Return the choice of the last start; None where there is none, or its scene no longer exists."""
    kept = read_config(LAUNCHER)
    scene, settings = find_shipped(str(kept.get("scene", ""))), kept.get("settings")
    if scene is None or not isinstance(settings, dict):
        return None
    return LauncherChoice(scene.file, {str(name): str(value) for name, value in settings.items()})


def _choices(words: Mapping[str, str]) -> list[SettingChoice]:
    return [SettingChoice(value, text) for value, text in words.items()]


def _card(scene: ShippedScene, last: EarlierRun | None) -> ScenarioCard:
    return ScenarioCard(
        title=scene.title,
        description=scene.description,
        picture=thumbnail_of(scene.name),
        scene=scene.file,
        group=GROUPS[scene.group],
        facts=" · ".join(part for part in (scene.takes, scene.lasts) if part),
        limits=_beyond(scene),
        refuses=refusals(scene),
        badge="" if last is None or last.score is None else phrase("last: {score:.0f} of 100", score=last.score),
    )


def _beyond(scene: ShippedScene) -> str:
    return phrase("beyond the usual limits: {limits}", limits=scene.limits) if scene.limits else ""


def _recent_card(run: EarlierRun) -> ScenarioCard | None:
    """Return the card of a session; None where its scene is not a shipped one."""
    scene = find_shipped(run.scene)
    if scene is None:
        return None
    return ScenarioCard(
        title=scene.title,
        description=_how_it_went(run),
        picture=thumbnail_of(scene.name),
        scene=scene.file,
        group=phrase("Recent"),
        facts=" · ".join(part for part in (local_time(run.utc), _who(run)) if part),
        badge="" if run.score is None else phrase("{score:.0f} of 100", score=run.score),
        everywhere=False,
        run=run.folder,
    )


def _how_it_went(run: EarlierRun) -> str:
    if run.cut_off:
        return phrase("Cut off: its recording was not closed.")
    if not run.trials:
        return practice_only(run.practised) if run.practised else phrase("Broken off before a trial came to its end.")
    finished = finished_words(run.completed, run.trials)
    if run.time_s is None:
        return finished
    if run.trials == 1:
        return phrase("{finished:s}, time {seconds:.1f} s.", finished=finished, seconds=run.time_s)
    return phrase("{finished:s}, mean time {seconds:.1f} s.", finished=finished, seconds=run.time_s)


def _who(run: EarlierRun) -> str:
    return run.participant or (load_built_in(SIMULATED).caption if run.simulated else "")
