"""`mimics run SCENE`: a window with a person at it, or headless with the simulated patient on the virtual clock."""

from __future__ import annotations

import argparse
import sys
from contextlib import nullcontext
from dataclasses import fields
from pathlib import Path

from mimics_app.app.settings import (
    DIFFICULTIES,
    OPERATOR_LOST,
    PATIENTS,
    PICTURE_OPTIONS,
    QUALITIES,
    RECIPES,
    SIDES,
    SOUNDS,
    RunSettings,
)
from mimics_app.app.terminal.arguments import (
    Container,
    add_display_argument,
    add_profile_argument,
    add_window_size_argument,
    participant_code,
    path_to_write,
    positive_time,
    random_seed,
    whole_number,
)
from mimics_app.app.terminal.output import answer, say
from mimics_app.contracts.system.language import LANGUAGES, speak
from mimics_app.contracts.system.phrases import phrase

__all__ = ["add_arguments", "check_names", "run"]

_DEFAULT_SCENE = Path("scenes/wavy_tunnel.json")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics run`."""
    parser.epilog = (
        "In the window: H lists all keys, Space stops the force, P pauses, Esc ends; F1 frame times, F2 wireframe, "
        "F3 bounds, F4 lights, F5 forces and contacts, F6 shadow atlas, F11 full screen, F12 saves a picture. Scene, "
        "models and shaders are reloaded when their files change."
    )
    parser.add_argument(
        "scene",
        type=Path,
        nargs="?",
        default=_DEFAULT_SCENE,
        help="scene file, or the name of a shipped scene, see mimics scenes (default: wavy_tunnel)",
    )
    _add_person(parser.add_argument_group("who plays"))
    _add_trials(parser.add_argument_group("task and trials"))
    _add_device(parser.add_argument_group("device and real time"))
    _add_outputs(parser.add_argument_group("picture, sound and recording"))
    _add_operator(parser.add_argument_group("operator"))
    _add_adaptation(parser.add_argument_group("body signals and adaptation"))
    parser.add_argument("--journey", type=Path, metavar="FILE", help=argparse.SUPPRESS)


def _add_person(group: Container) -> None:
    group.add_argument(
        "--headless", action="store_true", help="no window: a simulated patient plays, as fast as the machine allows"
    )
    group.add_argument(
        "--participant",
        type=participant_code,
        default="",
        metavar="CODE",
        help="code of the person, never a name; results of the same code are compared",
    )
    group.add_argument(
        "--language",
        choices=tuple(LANGUAGES),
        default="",
        help="language of the texts that the person sees (default: as last chosen in the launcher, else the system's)",
    )
    group.add_argument(
        "--fit",
        type=Path,
        metavar="RUN",
        help="fit paths, grips, speeds, text and volume to a person: run folder of their calibration, or a file of a "
        "fit; none: as the scene has them (default: the newest calibration of the participant)",
    )
    group.add_argument(
        "--side",
        choices=SIDES,
        default="right",
        help="side of the person that plays; left: the mirror image of the scene, where it has one",
    )
    group.add_argument(
        "--avatar",
        type=Path,
        metavar="FILE",
        help="model that is the person's own body, where the scene shows one; mimics avatar make writes such models "
        "(default: as kept with the participant)",
    )
    group.add_argument("--larger-text", action="store_true", help="enlarge all that is shown over the picture")
    group.add_argument(
        "--high-contrast", action="store_true", help="texts, targets, paths and the hand's marker in high contrast"
    )
    group.add_argument(
        "--patient",
        choices=PATIENTS,
        default="",
        help="impairment of the simulated patient (default: as in the scene)",
    )


def _add_trials(group: Container) -> None:
    group.add_argument(
        "--difficulty",
        choices=DIFFICULTIES,
        default="usual",
        help="easier, harder: start the adaptable parameters half-way to their easiest or hardest value",
    )
    group.add_argument(
        "--trials",
        type=whole_number("number of trials", range(1, 10_001)),
        default=0,
        metavar="N",
        help="number of trials, practice not counted (default: as in the scene)",
    )
    group.add_argument(
        "--from-trial",
        type=whole_number("number of a trial", range(1, 1_000_001)),
        default=1,
        metavar="N",
        help="trial to start with, to continue a session that was broken off; the same --seed gives the same order",
    )
    group.add_argument(
        "--commands",
        type=Path,
        metavar="FILE",
        help="give the commands of a JSON file, each at its time: pause, resume, skip, set_parameter ...",
    )
    group.add_argument("--seconds", type=positive_time, help="end after this much simulated time [s]")
    group.add_argument("--seed", type=random_seed, default=1, help="seed of trial order, patient and sensor noise")


def _add_device(group: Container) -> None:
    group.add_argument(
        "--device",
        default="",
        help="device to play with (default: the scene's robot; in a window the mouse); see mimics devices",
    )
    group.add_argument("--recording", type=Path, metavar="RUN", help="with --device replay: run folder to play back")
    group.add_argument(
        "--recipe",
        choices=RECIPES,
        default="auto",
        help="scheduling of the live haptic loop: fifo is real-time priority; auto takes the best one permitted",
    )


def _add_outputs(group: Container) -> None:
    add_profile_argument(group)
    group.add_argument(
        "--quality",
        choices=QUALITIES,
        default="auto",
        help="auto: lower the picture's quality where a frame would take too long; full: never",
    )
    group.add_argument(
        "--opt",
        choices=PICTURE_OPTIONS,
        default="",
        help="nosoftware: without a graphics card, draw as on one, for comparison: the same picture, more slowly",
    )
    add_window_size_argument(group)
    add_display_argument(group)
    group.add_argument(
        "--sound",
        choices=SOUNDS,
        default="auto",
        help="device: sound output of this computer; file: sound.wav in the run folder; off: none; auto: device in a "
        "window, with --headless mixed for the report only",
    )
    group.add_argument(
        "--pictures",
        type=whole_number("number of pictures", range(100_001)),
        default=4,
        metavar="N",
        help="with --headless: number of pictures to draw and save",
    )
    group.add_argument(
        "--video",
        type=path_to_write,
        metavar="FILE",
        help="write a video of the run, e.g. out.mp4 (needs ffmpeg); a folder: every frame as PNG",
    )
    group.add_argument(
        "--steer", default="", metavar="NAME", help="let a program of an installed package give commands, by its name"
    )
    group.add_argument(
        "--markers",
        default="",
        metavar="NAME",
        help="take notes, marks and stops from a marker stream of the lab streaming layer, live only (extra lsl)",
    )
    group.add_argument(
        "--lsl",
        action="store_true",
        help="send poses, forces, features, state and markers to the lab streaming layer (extra lsl)",
    )
    group.add_argument(
        "--runs", type=Path, default=Path("runs"), metavar="DIR", help="folder in which the run folder is created"
    )


def _add_operator(group: Container) -> None:
    group.add_argument(
        "--console",
        type=whole_number("port", range(65536)),
        nargs="?",
        const=8765,
        metavar="PORT",
        help="serve the operator's page, and run by the wall clock; a page of mimics console finds every live session",
    )
    group.add_argument(
        "--operator-lost",
        choices=OPERATOR_LOST,
        default="pause",
        help="what follows when the operator's page was there and is lost for two seconds",
    )
    group.add_argument("--despite", default="", help=argparse.SUPPRESS)


def _add_adaptation(group: Container) -> None:
    group.add_argument("--action", type=Path, metavar="FILE", help="replay task actions from a JSON file")
    group.add_argument(
        "--physio",
        default="",
        metavar="SOURCE",
        help="body signals: sim, sim:PRESET, file:PATH, lsl:NAME, serial:PORT, board:NAME, or an installed one",
    )
    group.add_argument(
        "--baseline-s",
        type=positive_time,
        default=60.0,
        metavar="S",
        help="with --physio: length of the baseline measured at rest before the first trial [s]",
    )
    group.add_argument(
        "--estimator",
        default="",
        metavar="NAME",
        help="estimator of the person's load: fusion, lda, adaptive_lda, or an installed one (default: the task's)",
    )
    group.add_argument(
        "--learn",
        default="",
        metavar="POLICY",
        help="policy that adapts the task, e.g. kalman, staircase (default: the task's)",
    )
    group.add_argument(
        "--goal",
        default="",
        help="goal of the policy: task, success:SHARE, or arousal, valence or effort:LOW:HIGH (default: the task's)",
    )


def run(args: argparse.Namespace) -> int:
    """Run the scene and print its result."""
    from mimics_app.app.terminal.participant_language import usual_language

    args.language = args.language or usual_language()
    if args.journey is None and sys.stderr.isatty():  # seconds pass before a window or a bar shows anything
        say(f"loading {args.scene.stem}: touch, sound, picture")
    from mimics_app.app.play.journey_log import JourneyLog

    with JourneyLog(args.journey).reporting():
        check_names(args)
        _check_screen(args)
        take_kept_with_participant(args)
    from mimics_app.app.scenes.shipped import is_only_looked_at

    if is_only_looked_at(args.scene) and not args.headless:
        return _view(args)
    if args.console is not None:
        from mimics_app.app.play.operators_page import start_page

        start_page(args.console)
    settings = RunSettings(**{field.name: getattr(args, field.name) for field in fields(RunSettings)})
    speak(settings.language)
    if settings.high_contrast:
        from mimics_app.rendering.visual.figures.contrast import use_high_contrast

        use_high_contrast(True)
    if _is_for_a_person(settings) and not args.json:
        return _play_with_pages(settings)
    return _play(settings, as_json=args.json)


def take_kept_with_participant(args: argparse.Namespace) -> None:
    """Take what is kept with the participant where nothing is stated: the own body, and the calibration."""
    args.avatar = args.avatar or _own_body(args)
    args.fit = args.fit or _own_fit(args)


def _own_fit(args: argparse.Namespace) -> Path | None:
    """Return the newest calibration of the participant, None where there is none, or the scene is a calibration."""
    if not args.participant:
        return None
    from mimics_app.app.study.studies import fit_of_code
    from mimics_app.app.study.study_runs import CALIBRATION

    found = None if args.scene.stem == CALIBRATION else fit_of_code(args.participant, args.runs)
    if found is not None:
        say(f"fitted to the calibration of {args.participant} ({found}); --fit none leaves the scene as it is")
    return found


def _own_body(args: argparse.Namespace) -> Path | None:
    """Return the model that is kept with the participant, None where there is none, or the scene shows no own body."""
    if not args.participant:
        return None
    from mimics_app.app.study.studies import body_of_code

    body = body_of_code(args.participant, args.runs, args.scene)
    if body.why_not:
        say(body.why_not)
    return body.file


def _play_with_pages(settings: RunSettings) -> int:
    """Play the scene in a process of its own, with pages before and after it in a window of this one."""
    from mimics_app.app.play.journey import play_through
    from mimics_app.app.play.journey_window import JourneyWindow
    from mimics_app.app.scenes.shipped import find_shipped

    with JourneyWindow(settings.size, origin="terminal") as window:
        known = find_shipped(settings.scene.stem)
        window.title = settings.scene.stem if known is None else known.title
        ended = play_through(settings, window)
        if ended.code < 0:  # killed: its own process could not report it
            say(ended.error)
            return 128 - ended.code
        if ended.following != "other":
            return ended.code
        from mimics_app.app.commands.launch import launch_in

        return launch_in(window)


def _play(settings: RunSettings, *, as_json: bool) -> int:
    """Play the scene in this process, after the settings are checked."""
    from mimics_app.app.play.journey_log import JourneyLog
    from mimics_app.app.session.requested import read_requested
    from mimics_app.app.terminal.first_start import say_if_cold

    log = JourneyLog(settings.journey)
    log.doing(phrase("Reading the scene"))
    with log.reporting():
        read = read_requested(settings)
    say_if_cold(log.doing)
    from mimics_app.app.play.play import play
    from mimics_app.rendering.visual.surfaces.rasteriser import without_software

    with without_software() if settings.opt == "nosoftware" else nullcontext():
        return play(settings, as_json=as_json, read=read)


def _view(args: argparse.Namespace) -> int:
    """Open the viewer on a scene without a task."""
    from mimics_app.app.play.journey_log import JourneyLog
    from mimics_app.app.terminal.display import has_display
    from mimics_app.contracts.errors import DeviceError

    if not has_display():
        raise DeviceError(
            "this scene is only looked at, which needs a display",
            f"without one: mimics view {args.scene} --output view.png",
        )
    say("this scene has no task; it opens in the viewer")
    log = JourneyLog(args.journey)
    log.doing(phrase("Reading the scene"))
    from mimics_app.app.viewer.shown import open_shown
    from mimics_app.app.viewer.viewer_window import ViewerSession

    with ViewerSession(open_shown(args.scene, "y"), args.size, args.profile, "", "y") as session:
        session.run(log.shown)
    log.looked_at()
    answer(args, {"looked_at": args.scene}, ())
    return 0


def _is_for_a_person(settings: RunSettings) -> bool:
    """Whether a person plays at a window and sees the results there; a script sets --seconds or --journey."""
    from mimics_app.app.terminal.display import has_display

    return not settings.headless and has_display() and settings.seconds is None and settings.journey is None


def _check_screen(args: argparse.Namespace) -> None:
    """Check that the screen of a session in a window answers."""
    from mimics_app.app.terminal.display import has_display

    if has_display() and not args.headless:
        from mimics_app.rendering.visual.surfaces.screen_check import check_screen

        check_screen()


def check_names(args: argparse.Namespace) -> None:
    """Check that everything named exists, before compiled code and graphics are imported."""
    from mimics_app.app.scenes.scene_search import find_scene
    from mimics_app.app.terminal.named import check_adaptation, check_files
    from mimics_app.recording.run_folder import check_parent

    args.scene = find_scene(args.scene)
    check_files(args.action, args.display, args.commands)
    check_parent(args.runs)
    if args.device:
        from mimics_app.rendering.haptic.devices.device_names import check_device_name
        from mimics_app.rendering.haptic.devices.device_search import find_device

        check_device_name(args.device)
        find_device(args.device, say)
    if args.physio:
        from mimics_app.inputs.physio.sources import find_source

        find_source(args.physio, say)
    if args.steer:
        from mimics_app.contracts.ports.command_port import open_steersman

        open_steersman(args.steer).close()
    if args.learn or args.goal or args.estimator:
        check_adaptation(args.learn, args.goal, args.estimator)
    if args.recording is not None:
        from mimics_app.recording.run import Run

        Run.open(args.recording)
