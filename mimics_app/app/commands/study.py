"""`mimics study SCENE`: run a scene for several simulated subjects, or join runs, into tidy tables and one page."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimics_app.app.terminal.arguments import folder_to_write, positive_time, random_seed, whole_number
from mimics_app.app.terminal.output import answer, say
from mimics_app.contracts.errors import PartialDataError

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics study`."""
    parser.add_argument("scene", type=Path, help="scene file, or the name of a shipped scene")
    parser.add_argument(
        "--subjects",
        type=whole_number("number of subjects", range(1, 1001)),
        default=2,
        metavar="N",
        help="number of simulated subjects",
    )
    parser.add_argument(
        "--seed",
        type=random_seed,
        default=1,
        help="seed of the first subject; each further subject has the next number",
    )
    parser.add_argument("--seconds", type=positive_time, help="end each run after this much simulated time [s]")
    parser.add_argument("--of", type=Path, nargs="+", metavar="RUN", help="join these run folders instead of running")
    parser.add_argument(
        "--out",
        type=folder_to_write,
        default=Path("study"),
        metavar="DIR",
        help="folder of the tables and the page",
    )


def run(args: argparse.Namespace) -> int:
    """Run or join, and write; exit code 6 where a subject's run is incomplete."""
    from mimics_app.app.scenes.loading import load_checked_scene
    from mimics_app.app.scenes.scene_search import find_scene
    from mimics_app.app.study.page import write_page
    from mimics_app.app.study.subjects import find_run, run_subject
    from mimics_app.app.study.tables import ANSWER_COLUMNS, TAP_COLUMNS, read_study, write_table
    from mimics_app.recording.run_folder import PRIVATE_FOLDER
    from mimics_app.world.files.scene.file import load_scene

    path = find_scene(args.scene)
    scene = load_scene(path) if args.of else load_checked_scene(path)
    args.out.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)
    if args.of:
        runs = [find_run(number, folder, scene.name) for number, folder in enumerate(args.of, start=1)]
    else:
        extra = ["--pictures", "0", "--sound", "off", *(["--seconds", str(args.seconds)] if args.seconds else [])]
        numbers = range(1, args.subjects + 1)
        runs = [run_subject(path, each, args.seed + each - 1, args.out / "runs", extra, say) for each in numbers]
    trials, taps, answers = read_study(runs)
    write_table(args.out / "trials.csv", trials)
    write_table(args.out / "taps.csv", taps, TAP_COLUMNS)
    write_table(args.out / "answers.csv", answers, ANSWER_COLUMNS)
    write_page(args.out / "study.html", scene.title or scene.name, runs, trials, taps)
    problems = [f"subject {each.subject}: {each.problem}" for each in runs if each.problem]
    for problem in problems:
        say(problem)
    counts = {"subjects": len(runs), "trials": len(trials), "taps": len(taps), "answers": len(answers)}
    report = args.out / "study.html"
    lines = [f"{counts['trials']} trials, {counts['taps']} taps, {counts['answers']} answers", str(report)]
    answer(args, {**counts, "folder": args.out, "report": report, "problems": problems}, lines)
    return PartialDataError.exit_code if problems else 0
