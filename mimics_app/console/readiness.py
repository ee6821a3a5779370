"""Before a session: what can be chosen, lights of what it needs, and the words of its command line.

The command line of this program answers all of it, see `command_line`.
"""

from __future__ import annotations

import asyncio
import shlex
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from mimics_app.console.command_line import ask_command
from mimics_app.contracts.system.phrases import phrase

__all__ = [
    "Choice",
    "Light",
    "StudyName",
    "Word",
    "files_of_next",
    "find_choices",
    "find_lights",
    "find_people",
    "start_words",
]

_LEAST_HOURS = 1.0
"""Hours of recording that must fit on the disk for a green light."""

Word = Annotated[str, Meta(max_length=120, pattern=r"^[^\x00-\x1f]*$")]

_DisplayName = Annotated[str, Meta(max_length=4200, pattern=r"^[^\x00-\x1f\ud800-\udfff]*$")]
"""Kind of a display, with the path of its file where it has one, which a file system takes up to 4096 bytes long."""

StudyName = Annotated[
    str, Meta(max_length=120, pattern=r"^([^/\\\x00-\x1f\ud800-\udfff.][^/\\\x00-\x1f\ud800-\udfff]*)?$")
]
"""Name of a folder that is shown, or ""."""


class Choice(msgspec.Struct, forbid_unknown_fields=True):
    """What the operator chose; "" and 0: as in the scene.

    Attributes:
        scene: Name of a shipped scene.
        participant: Code of the person.
        device: Device.
        display: Display, as --display takes it.
        difficulty: One of three.
        trials: Number of trials that count.
        physio: Source of body signals.
        study: Folder of a study in the folder of the page, whose next run is played; "": a session of no study. Scene,
            difficulty and number of trials are then those of the study.
        interrupted: What to do with a run of the study that was interrupted; "": nothing was.
        despite: What was not green when the session was started all the same; "": nothing.
    """

    scene: Annotated[str, Meta(pattern=r"^[A-Za-z0-9_]+$", max_length=80)]
    participant: Word = ""
    device: Word = ""
    display: _DisplayName = ""
    difficulty: Literal["easier", "usual", "harder"] = "usual"
    trials: Annotated[int, Meta(ge=0, le=10_000)] = 0
    physio: Word = ""
    study: StudyName = ""
    interrupted: Literal["", "resume", "restart-block"] = ""
    despite: Annotated[str, Meta(max_length=300)] = ""


class Light(msgspec.Struct):
    """One check.

    Attributes:
        name: What was checked.
        light: "green", "amber" (works without it) or "red".
        found: What was found.
        remedy: What to do; "" where nothing.
    """

    name: str
    light: Literal["green", "amber", "red"]
    found: str
    remedy: str = ""


def start_words(choice: Choice) -> list[str]:
    """Return the arguments of the program for a choice; "=": a value may begin with a hyphen."""
    named = {"device": choice.device, "display": choice.display, "physio": choice.physio, "despite": choice.despite}
    if choice.study:
        answer = [f"--{choice.interrupted}"] if choice.interrupted else []
        options = shlex.join(["--console", *_given(named)])
        return ["study", f"--options={options}", *answer, "--", "run", choice.study, choice.participant]
    named |= {"participant": choice.participant, "difficulty": choice.difficulty, "trials": str(choice.trials or "")}
    return ["run", choice.scene, "--console", *_given(named)]


def _given(named: Mapping[str, str]) -> list[str]:
    return [f"--{name}={value}" for name, value in named.items() if value]


async def find_choices() -> dict[str, Any]:
    """Return the scenes, devices and displays of this installation."""
    scenes, devices = await asyncio.gather(ask_command("scenes"), ask_command("devices"))
    return {
        "scenes": [
            {"name": each["name"], "title": each.get("title", each["name"]), "group": each.get("group", "")}
            for each in scenes.get("scenes", [])
            if each.get("group") != "places"
        ],
        "devices": [{"name": each["name"], "title": each.get("about", "")} for each in devices.get("devices", [])],
        "displays": [
            *({"name": each["name"], "title": each["about"]} for each in _kinds(devices) if _is_ready(each)),
            *({"name": each["write"], "title": ""} for each in devices.get("display_files", []) if _can_be_shown(each)),
        ],
    }


async def find_people() -> dict[str, Any]:
    """Return the codes of the participants of each study in the folder of the page, and those recorded in no study."""
    found = await ask_command("study", "status")
    studies = found.get("studies", {})
    return {
        "studies": {name: codes for name, codes in studies.items() if _can_be_chosen(name)},
        "recorded": found.get("recorded", []),
    }


def _kinds(devices: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the kinds of display in the object of `mimics devices --json`."""
    kinds: list[Mapping[str, Any]] = devices.get("display_kinds", [])
    return kinds


def _is_ready(kind: Mapping[str, Any]) -> bool:
    """Return whether a kind of display is there, and needs no file."""
    return not kind.get("error") and not str(kind["write"]).endswith(":FILE")


def _can_be_shown(file: Mapping[str, Any]) -> bool:
    """Return whether the file of a display has no error, and a `Choice` takes its path."""
    return not file["error"] and _takes(_DisplayName, file["write"])


def _can_be_chosen(study: str) -> bool:
    """Return whether a `Choice` takes the name of a study: it is neither hidden nor too long."""
    return _takes(StudyName, study)


def _takes(kind: object, text: str) -> bool:
    try:
        msgspec.convert(text, kind)
    except msgspec.ValidationError:
        return False
    return True


async def find_lights(choice: Choice) -> list[Light]:
    """Return a light for each thing that a session of this choice needs."""
    first = ask_command("study", "--", "status", choice.study) if choice.study else ask_command("scenes")
    found, devices, doctor = await asyncio.gather(first, ask_command("devices"), ask_command("doctor"))
    return [
        *await (_lights_of_study if choice.study else _lights_of_scene)(choice, found),
        device_light(choice, devices),
        signal_light(choice),
        *machine_lights(doctor),
        *shown_light(choice, devices),
    ]


async def _lights_of_scene(choice: Choice, scenes: Mapping[str, Any]) -> list[Light]:
    file = next((each["file"] for each in scenes.get("scenes", []) if each["name"] == choice.scene), "")
    checked = await ask_command("check", file) if file else {"errors": [{"what": f"there is no scene {choice.scene}"}]}
    return [scene_light(checked), tracker_light(checked)]


async def _lights_of_study(choice: Choice, status: Mapping[str, Any]) -> list[Light]:
    files = files_of_next(choice, status)
    checked = await ask_command("check", *files) if files else {}
    return [study_light(choice, status), *([scene_light(checked), tracker_light(checked)] if files else [])]


def files_of_next(choice: Choice, status: Mapping[str, Any]) -> list[str]:
    """Return the scene that the participant of a study plays next; all of the study for a new one, none at the end.

    Args:
        choice: What was chosen.
        status: Object of `mimics study status --json`.
    """
    scenes: dict[str, str] = status.get("scenes", {})
    for found in status.get("participants", []):
        if found.get("participant") == choice.participant:
            return [] if found.get("over") else [scenes[found["condition"]]]
    return list(dict.fromkeys(scenes.values()))


def machine_lights(doctor: Mapping[str, Any]) -> list[Light]:
    """Return the lights of the computer, by the object of `mimics doctor --json`."""
    runs, sound, scheduler = doctor.get("runs", {}), doctor.get("al", {}), doctor.get("scheduler", {})
    hours = float(runs.get("free_gb", 0.0)) / (float(runs.get("gb_an_hour", 0.0)) or 1.0)
    room: Literal["green", "red"] = "green" if runs.get("writable") and hours >= _LEAST_HOURS else "red"
    monitors = doctor.get("displays", {}).get("monitors", [])
    fifo = bool(scheduler.get("fifo"))
    return [
        Light(
            phrase("disk"),
            room,
            phrase("room for {hours:.0f} h of recording", hours=hours),
            "" if room == "green" else phrase("free some space, or start the page in another folder"),
        ),
        Light(
            phrase("sound"),
            "green" if sound.get("ok") else "amber",
            str(sound.get("device") or sound.get("error") or phrase("ready")),
            "" if sound.get("ok") else phrase("connect loudspeakers; without them the session is silent"),
        ),
        Light(
            phrase("display"),
            "green" if monitors else "amber",
            ", ".join(map(str, monitors)) or phrase("none"),
            "" if monitors else phrase("connect a screen; without one the session draws nothing"),
        ),
        Light(
            phrase("real time"),
            "green" if fifo else "amber",
            phrase("real-time priority") if fifo else phrase("no real-time priority"),
            "" if fifo else phrase("mimics doctor prints the line that allows it"),
        ),
    ]


def scene_light(checked: Mapping[str, Any]) -> Light:
    """Return the light of the scene, by the object of `mimics check --json`."""
    errors = checked.get("errors", [])
    if not errors:
        return Light(phrase("scene"), "green", phrase("no errors"))
    first = errors[0]
    return Light(
        phrase("scene"),
        "red",
        str(first.get("what", "")),
        str(first.get("fix", "") or phrase("mimics check names the place")),
    )


def study_light(choice: Choice, status: Mapping[str, Any]) -> Light:
    """Return the light of the next run of a study, by the object of `mimics study status --json`."""
    name = phrase("study")
    if "participants" not in status:
        why = next((str(each.get("what", "")) for each in status.get("errors", [])), phrase("no answer"))
        return Light(name, "red", why, phrase("mimics study status says more"))
    if not choice.participant:
        return Light(name, "red", phrase("no participant"), phrase("enter the code of the participant"))
    found = next((each for each in status["participants"] if each.get("participant") == choice.participant), None)
    if found is None:
        return Light(
            name, "amber", phrase("this participant is new in the study"), phrase("look whether the code is right")
        )
    if found.get("over"):
        return Light(name, "red", phrase("all runs of this participant are done"), phrase("choose another participant"))
    planned = {each: str(found.get(each)) for each in ("run", "session", "condition")}
    if "resume_at" in found and not choice.interrupted:
        said = phrase("run {run} of session {session}, {condition}, was interrupted", **planned)
        return Light(name, "red", said, phrase("choose to resume it or to begin it again"))
    if choice.interrupted and "resume_at" not in found:
        said = phrase("run {run} of session {session}, {condition}, was not interrupted", **planned)
        return Light(name, "red", said, phrase("choose nothing to be resumed"))
    return Light(name, "green", phrase("run {run} of session {session}: {condition}", **planned))


def device_light(choice: Choice, devices: Mapping[str, Any]) -> Light:
    """Return the light of the device: that it is installed; whether it answers is seen at the start."""
    wanted = choice.device.partition(":")[0]
    known = {str(each.get("name", "")) for each in devices.get("devices", [])}
    if not wanted or wanted in known:
        return Light(phrase("device"), "green", wanted or phrase("that of the scene"))
    return Light(
        phrase("device"),
        "red",
        phrase("{device} is not installed", device=wanted),
        phrase("choose another one; mimics devices lists them"),
    )


def shown_light(choice: Choice, devices: Mapping[str, Any]) -> list[Light]:
    """Return the light of a display that was chosen; none for the usual one."""
    if not choice.display:
        return []
    kind = next((each for each in _kinds(devices) if each["name"] == choice.display.partition(":")[0]), None)
    why = phrase("{device} is not installed", device=choice.display) if kind is None else str(kind.get("error", ""))
    remedy = phrase("choose another one; mimics devices lists them") if why else ""
    return [Light(phrase("chosen display"), "red" if why else "green", why or choice.display, remedy)]


def tracker_light(checked: Mapping[str, Any]) -> Light:
    """Return the light of the trackers of a scene, by the object of `mimics check --json`."""
    names = ", ".join(str(each) for file in checked.get("files", []) for each in file.get("trackers", []))
    if not names:
        return Light(phrase("trackers"), "green", phrase("none"))
    remedy = phrase("switch them on; the session reports a tracker that it does not find")
    return Light(phrase("trackers"), "amber", phrase("{file}: sought at the start", file=names), remedy)


def signal_light(choice: Choice) -> Light:
    """Return the light of the body signals: a simulated person is there; an amplifier is sought at the start."""
    kind = choice.physio.partition(":")[0]
    if kind in ("", "sim"):
        return Light(phrase("body signals"), "green", phrase("simulated") if kind else phrase("none"))
    remedy = phrase("switch the amplifier on; the session reports a source that it does not find")
    return Light(
        phrase("body signals"), "amber", phrase("{source} is sought at the start", source=choice.physio), remedy
    )
