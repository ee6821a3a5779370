"""Contents of the launcher in a therapist's words: scenes, settings, recent runs, and the last choice."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mimics_app.app.installation.display_files import find_display_files
from mimics_app.app.installation.serial_ports import list_serial_ports
from mimics_app.app.play.operators_page import DEFAULT_PORT, can_serve
from mimics_app.app.play.players import ADDRESSED, players, refusals
from mimics_app.app.scenes.shipped import GROUPS, ShippedScene, find_shipped, shipped_scenes, thumbnail_of
from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.participant import canonical_code, why_no_code
from mimics_app.app.terminal.user_files import read_config, write_config
from mimics_app.contracts.errors import counted
from mimics_app.contracts.ports.display_choice import display_names, kind_of_display
from mimics_app.recording.history import EarlierRun, cut_off_runs, local_time, recent_runs
from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, SIMULATED, load_built_in
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice, ScenarioCard
from mimics_app.rendering.visual.launcher.setting import Choice, Setting

__all__ = ["cut_off_notice", "last_choice", "launcher_cards", "launcher_settings", "remember", "settings_of_choice"]

_FILE = "launcher"
_MOST_RECENT = 12
_SIMULATED = tuple(name for name in BUILT_IN if name.startswith("simulated"))


def launcher_settings() -> list[Setting]:
    """Return the settings of the launcher, with the devices and displays of this installation."""
    return [*_person_settings(), *_task_settings(), *_output_settings()]


def _person_settings() -> list[Setting]:
    """Return the settings of person, device and participant code."""
    return [
        Setting(
            "device", "Who plays", "A person at this computer, a robot, or a simulated patient.", _choices(players())
        ),
        Setting(
            "address",
            "Port or address of the robot",
            "Of a serial robot e.g. /dev/ttyUSB0; of a HapticMaster its address, e.g. 192.168.0.10.",
            _choices({each["port"]: each["port"] for each in list_serial_ports()}),
            typed=True,
            empty="type it here",
            with_values=ADDRESSED,
        ),
        Setting(
            "patient",
            "Simulated patient",
            "How much the simulated patient is impaired.",
            _choices({"": "usual for the scene", "healthy": "healthy", "moderate": "moderate", "severe": "severe"}),
            with_values=_SIMULATED,
        ),
        Setting(
            "participant",
            "Participant code",
            "A code, never a name. Results are compared with earlier ones of this code.",
            typed=True,
            empty="none",
            refuse=lambda typed: why_no_code(canonical_code(typed)),
        ),
    ]


def _task_settings() -> list[Setting]:
    """Return the settings of difficulty and number of trials."""
    return [
        Setting(
            "difficulty",
            "Difficulty",
            "Easier: for most scenes wider, softer, and with help of the robot. Harder: narrower and stiffer.",
            _choices({"usual": "usual", "easier": "easier", "harder": "harder"}),
        ),
        Setting(
            "trials",
            "Number of trials",
            "Trials that count. Practice is extra.",
            _choices({"": "usual for the scene", **{str(n): str(n) for n in (1, 2, 3, 5, 10, 20)}}),
        ),
    ]


def _output_settings() -> list[Setting]:
    """Return the settings of picture and sound."""
    kinds = {name: kind_of_display(name) for name in display_names()}
    captions = {name: kind.caption for name, kind in kinds.items() if kind.file != "must"}
    displays = {"": "this screen, or the scene's display", **captions, **_found_displays()}
    return [
        Setting(
            "profile",
            "Quality",
            "Usual and fast: a simpler picture where the computer is slow. Study: always the full picture.",
            _choices({"training": "usual", "draft": "fast", "study": "study, nothing lowered"}),
        ),
        Setting(
            "sound",
            "Sound",
            "On plays through this computer; a file is written into the recording.",
            _choices({"auto": "on", "file": "into a file", "off": "off"}),
        ),
        Setting(
            "display",
            "Display",
            "On what the picture is shown.",
            _choices(displays),
        ),
        Setting(
            "console",
            "Operator's page",
            "Opens in a browser, for the second screen: to watch, pause, stop and adjust the session.",
            _choices({"": "off", **({"open": "open on the second screen"} if can_serve() else {})}),
        ),
    ]


def _found_displays() -> dict[str, str]:
    """Return the walls and headsets whose files in this folder are right."""
    return {one["write"]: one["write"] for one in find_display_files(Path.cwd()) if not one["error"]}


def settings_of_choice(choice: LauncherChoice) -> RunSettings:
    """Return the person's choice as the settings of a run."""
    chosen = choice.settings
    device = chosen["device"]
    if device in ADDRESSED:
        device = f"{device}:{chosen['address']}"
    return RunSettings(
        scene=choice.scene,
        device=device,
        patient=chosen["patient"] if chosen["device"] in _SIMULATED else "",
        participant=canonical_code(chosen["participant"]),
        difficulty=chosen["difficulty"],  # type: ignore[arg-type]
        trials=int(chosen["trials"] or 0),
        profile=chosen["profile"],  # type: ignore[arg-type]
        sound=chosen["sound"],  # type: ignore[arg-type]
        display=chosen["display"],
        console=DEFAULT_PORT if chosen.get("console") else None,
    )


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
    more = f" (and {len(left) - 1} before it)" if len(left) > 1 else ""
    return f"A session{more} was cut off; this repairs its recording: mimics record recover {left[0]}"


def remember(choice: LauncherChoice) -> None:
    """Keep the choice for the next start."""
    write_config(_FILE, {"scene": choice.scene.stem, "settings": choice.settings})


def last_choice() -> LauncherChoice | None:
    """Return the choice of the last start; None where there is none, or its scene no longer exists."""
    kept = read_config(_FILE)
    scene, settings = find_shipped(str(kept.get("scene", ""))), kept.get("settings")
    if scene is None or not isinstance(settings, dict):
        return None
    return LauncherChoice(scene.file, {str(name): str(value) for name, value in settings.items()})


def _choices(words: Mapping[str, str]) -> list[Choice]:
    return [Choice(value, text) for value, text in words.items()]


def _card(scene: ShippedScene, last: EarlierRun | None) -> ScenarioCard:
    return ScenarioCard(
        title=scene.title,
        description=scene.description,
        picture=thumbnail_of(scene.name),
        scene=scene.file,
        group=GROUPS[scene.group],
        facts=" · ".join(part for part in (scene.takes, scene.lasts, _beyond(scene)) if part),
        refuses=refusals(scene),
        badge=f"last: {last.score:.0f} of 100" if last is not None and last.score is not None else "",
    )


def _beyond(scene: ShippedScene) -> str:
    return f"beyond the usual limits: {scene.limits}" if scene.limits else ""


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
        group="Recent",
        facts=" · ".join(part for part in (local_time(run.utc), _who(run)) if part),
        badge="" if run.score is None else f"{run.score:.0f} of 100",
        everywhere=False,
        run=run.folder,
    )


def _how_it_went(run: EarlierRun) -> str:
    if run.cut_off:
        return "Cut off: its recording was not closed."
    if not run.trials:
        practised = f"Practice only: {counted(run.practised, 'trials')}." if run.practised else ""
        return practised or "Broken off before a trial came to its end."
    mean = "mean time" if run.trials > 1 else "time"
    words = [f"{run.completed} of {counted(run.trials, 'trials')} finished"]
    words += [f"{mean} {run.time_s:.1f} s"] if run.time_s is not None else []
    return ", ".join(words) + "."


def _who(run: EarlierRun) -> str:
    return run.participant or (load_built_in(SIMULATED).caption if run.simulated else "")
