"""`mimics study SCENE`: run a scene for several simulated subjects, or join runs, into tidy tables and one page.

`mimics study new|run|form|status|next|export|erase FOLDER`: a study with participants, sessions and a protocol.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mimics_app.app.study.counterbalance import ORDERS
from mimics_app.app.terminal.arguments import Container, folder_to_write, positive_time, random_seed, whole_number
from mimics_app.app.terminal.output import answer, say
from mimics_app.contracts.errors import PartialDataError, UsageError
from mimics_app.contracts.system.language import LANGUAGES, speaking

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics study`."""
    parser.epilog = (
        "With a verb: new FOLDER SCENE.. makes a study; run FOLDER CODE plays the next run of a participant; form "
        "FOLDER CODE FORM ITEM=VALUE .. keeps the answers to a questionnaire, and without answers shows it; next and "
        "status FOLDER say what comes and what is done, status alone lists the studies here and their participants; "
        "export FOLDER --out DIR writes tables and pages; erase FOLDER CODE removes a participant. See "
        "docs/guide/studies.md."
    )
    parser.add_argument(
        "scene",
        type=Path,
        metavar="SCENE|VERB",
        help="scene file or name of a shipped scene; or new, run, form, status, next, export, erase",
    )
    parser.add_argument(
        "words", nargs="*", metavar="WORD", help="with a verb: folder of the study, then its code or scenes"
    )
    _add_verbs(parser.add_argument_group("with a verb"))
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


def _add_verbs(group: Container) -> None:
    group.add_argument("--protocol", type=Path, metavar="FILE", help="new: protocol as JSON, instead of scenes")
    group.add_argument("--order", choices=ORDERS, default="fixed", help="new: order of the scenes of each participant")
    group.add_argument(
        "--sessions",
        type=whole_number("number of sessions", range(1, 1001)),
        default=1,
        help="new: of each participant",
    )
    group.add_argument(
        "--form", action="append", default=[], metavar="NAME", help="new: take a shipped form: nasa_tlx, person"
    )
    group.add_argument(
        "--answers", type=Path, metavar="FILE", help='form: answers as JSON, by item; "-": those of standard input'
    )
    group.add_argument("--known", action="store_true", help="form: add nobody, refuse a code that the study has not")
    group.add_argument(
        "--person", default="", metavar="NAME", help="run: name instead of a code; kept in the key file only"
    )
    group.add_argument(
        "--language",
        choices=tuple(LANGUAGES),
        default="",
        help="run: language of the texts that the participant sees, kept for later runs; otherwise that of the pages",
    )
    group.add_argument("--options", default="", metavar="TEXT", help='run: options of mimics run, e.g. "--headless"')
    chosen = group.add_mutually_exclusive_group()
    chosen.add_argument("--resume", action="store_true", help="run: continue an interrupted run at its next trial")
    chosen.add_argument("--restart-block", action="store_true", help="run: begin an interrupted run again")
    chosen.add_argument("--abandon", action="store_true", help="run: leave an interrupted run out")


def run(args: argparse.Namespace) -> int:
    """Do a verb, or run or join and write; exit code 6 where a subject's run is incomplete."""
    from mimics_app.app.study.verbs import VERBS, do_verb

    if str(args.scene) in VERBS:
        return do_verb(args)
    if args.words:
        raise UsageError(f"mimics study {args.scene} takes no further words", f"verbs: {', '.join(VERBS)}")
    from mimics_app.app.scenes.loading import load_checked_scene
    from mimics_app.app.scenes.scene_search import find_scene
    from mimics_app.app.study.page import write_page
    from mimics_app.app.study.subjects import find_run, run_subject
    from mimics_app.app.study.tables import read_study, write_table
    from mimics_app.app.terminal.participant_language import usual_language
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
    trials, tables = read_study(runs)
    write_table(args.out / "trials.csv", trials)
    for name, table in tables.items():
        if table.rows:
            write_table(args.out / f"{name}.csv", table.rows, table.columns)
    with speaking(args.language or usual_language()):
        write_page(args.out / "study.html", scene.title or scene.name, runs, trials, tables)
    problems = [f"subject {each.subject}: {each.problem}" for each in runs if each.problem]
    for problem in problems:
        say(problem)
    counts = {"subjects": len(runs), "trials": len(trials), **{name: len(each.rows) for name, each in tables.items()}}
    report = args.out / "study.html"
    lines = [", ".join(f"{count} {name}" for name, count in counts.items() if count), str(report)]
    answer(args, {**counts, "folder": args.out, "report": report, "problems": problems}, lines)
    return PartialDataError.exit_code if problems else 0
