"""`mimics bench WHAT`: measure the product beside its peers, in the same run on this machine."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from mimics_app.app.terminal.arguments import add_size_argument, picture_file, positive_time, real_number, whole_number
from mimics_app.app.terminal.output import answer, applicable, finite
from mimics_app.contracts.errors import DeviceError, UsageError

__all__ = ["add_arguments", "run"]

_KINDS = ("product", "rival_python_thread", "unprivileged")
_SECONDS, _ALL_SECONDS, _AUDIO_SECONDS = 60.0, 10.0, 10.0
_FRAME_SECONDS, _ALL_FRAME_SECONDS = 12.0, 6.0
"""Default lengths of measurements [s]; `_ALL...`: limits where everything is measured. Stages of frames are timed last:
a measurement ends before the simulated patient has played its scene to the end."""

_PRESSES = 40
"""Default number of presses of STOP."""
_REPEATS = 5
"""Default number of sessions per way to kill one and per fault."""

_rounds = whole_number("number of rounds", range(1, 1001))
_frames = whole_number("number of frames", range(1, 1001))
_nodes = whole_number("number of nodes", range(1_000_001))
_frame_rate = real_number("frame rate from 1 to 1000", lambda fps: 1.0 <= fps <= 1000.0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics bench`."""
    parser.add_argument(
        "what",
        choices=("all", *_MEASURES, "render"),
        help="realtime: deadlines of the haptic loop under load; methods: cost and error of every method; audio: "
        "mixers and latency; haptic: cost of a tick; physio: R peaks and features; frame: frames of live sessions; "
        "software: what each part of drawing without a graphics card saves; "
        "displays: stereo and headsets; lokomat: control of the gait orthosis; "
        "record: what a killed session loses; faults: time from a fault to zero "
        "force; console: STOP, rate and cost of the operator's page; render: the renderer beside OGRE; all: methods, "
        "audio, haptic, frame and realtime",
    )
    _add_render_arguments(parser)
    parser.add_argument(
        "--surface", choices=("egl", "window"), default="egl", help="with frame: draw off screen (egl) or in a window"
    )
    parser.add_argument(
        "--charts",
        type=Path,
        metavar="DIR",
        help="with physio, audio, frame, lokomat: folder to write their figures to",
    )
    parser.add_argument(
        "--people",
        type=Path,
        metavar="FILE",
        help="with physio: only write the simulated people on whom the load estimator is trained",
    )
    parser.add_argument(
        "--soak",
        action="store_true",
        help="with audio: play 64 moving voices beside the load of realtime, for --seconds",
    )
    parser.add_argument(
        "--scene",
        type=Path,
        default=Path("scenes/wavy_tunnel.json"),
        help="scene of realtime, displays, record, faults, console and --soak",
    )
    parser.add_argument(
        "--seconds",
        type=positive_time,
        help="length of each measurement of realtime (default: 60), frame (12) and audio (10) [s]",
    )
    parser.add_argument(
        "--scale",
        type=float,
        choices=(0.75, 0.5),
        help="with frame: one more row at this resolution scale, and with all qualities lowered that the governor "
        "lowers before the scale",
    )
    parser.add_argument(
        "--rounds",
        type=_rounds,
        default=1,
        help="with realtime: number of measurements of each loop; the median is shown; with frame: of all scenes",
    )


def _add_render_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics bench render`, the same as those of the peers' harnesses."""
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="with render: city, nodes, crowd, walk, people, people_full or particles; with frame: scenes, walk or "
        "people (default: all); with software: scenes (default: wavy_tunnel, pick_and_place, avatar_cord); with "
        "physio: figures, or noise for a table of R peaks by kind of noise; with faults: numbers of docs/faults.md, "
        "F01 .. F20 (default: those that sessions and processes make; the others are repeated by their tests, in a "
        "checkout)",
    )
    parser.add_argument(
        "--data",
        type=Path,
        help="with render: folder of city.glb and cube.glb for city and nodes (default: $RENDER_DATA); with physio: "
        "folder of annotated .npz records (default: $PHYSIO_DATA)",
    )
    add_size_argument(parser, "with render, frame and displays: size of the picture [px]")
    parser.add_argument(
        "--msaa",
        type=int,
        choices=(0, 2, 4, 8),
        help="with render: samples per pixel (default: 0; for walk, as in a window)",
    )
    parser.add_argument(
        "--frames", type=_frames, default=40, help="with render, software and displays: number of frames timed"
    )
    parser.add_argument(
        "--warmup", type=_frames, default=6, help="with render: number of frames drawn before the timed ones"
    )
    parser.add_argument("--budget", type=positive_time, default=25.0, help="with render: stop after this time [s]")
    parser.add_argument(
        "--n",
        type=_nodes,
        default=0,
        help="with render: number of nodes, people or particles, 0: the default of the workload; with record and "
        "faults: number of sessions per kind of kill and per fault (default: 5); with console: presses of STOP (40)",
    )
    parser.add_argument(
        "--opt", default="", help="with render: options of the renderer, separated by commas, e.g. noocc,noshadow"
    )
    parser.add_argument(
        "--fps",
        type=_frame_rate,
        help="with render: lower the quality, as a run does, until this frame rate is held (default: never)",
    )
    parser.add_argument("--shot", type=picture_file, help="with render: PNG file for the last frame")


def run(args: argparse.Namespace) -> int:
    """Measure, and print a table or one JSON object."""
    if args.what == "render":
        return _run_render(args)

    if args.names and args.what not in ("faults", "frame", "physio", "software"):
        raise UsageError(
            f"bench {args.what} takes no further name: {' '.join(args.names)}", f"mimics bench {args.what}"
        )
    parts = ("methods", "audio", "haptic", "frame", "realtime") if args.what == "all" else (args.what,)
    figures: dict[str, Any] = {}
    for part in parts:
        measured = _MEASURES[part](args)
        figures.update(measured if len(parts) == 1 else {part: measured})
    answer(args, figures, [json.dumps(finite(figures), indent=2)])
    return 0


def _run_render(args: argparse.Namespace) -> int:
    from mimics_app.app.bench.workload_opening import WORKLOADS

    workload = args.names[0] if len(args.names) == 1 else ""
    if workload not in WORKLOADS:
        what = f'there is no workload "{" ".join(args.names)}"' if args.names else "the workload is missing"
        raise UsageError(what, f"mimics bench render {', '.join(WORKLOADS[:-1])} or {WORKLOADS[-1]}")
    from mimics_app.app.bench.render_bench import RenderBench, measure_render

    folder = args.data or _folder_of("RENDER_DATA")
    options = tuple(args.opt.replace(",", " ").split())
    figures = measure_render(
        RenderBench(
            workload,
            folder,
            size=args.size,
            msaa=args.msaa,
            frames=args.frames,
            warmup=args.warmup,
            budget=args.budget,
            count=args.n,
            options=options,
            shot=args.shot,
            fps=args.fps,
        )
    )
    figures |= _beside(args, workload, folder, figures)
    answer(args, figures, ["RESULT " + json.dumps(figures)])
    return 0


def _beside(args: argparse.Namespace, workload: str, folder: Path | None, ours: dict[str, Any]) -> dict[str, Any]:
    """Return OGRE's median frame time for the same workload, size and samples [ms]; {} where it is not measured."""
    from mimics_app.app.bench.ogre import OGRE_WORKLOADS, measure_ogre, measure_ogre_particles

    if workload == "particles":
        from mimics_app.app.bench.particles_workload import FountainNumbers

        numbers = FountainNumbers(count=args.n or FountainNumbers.count).as_dict
        row = measure_ogre_particles(numbers, args.size, args.frames, args.warmup, _say)
        if row is None:
            return {}
        share = ours["ms_cpu"] / row["ms_cpu"]
        beside = {"ogre_ms": row["ms_median"], "ogre_ms_cpu": row["ms_cpu"], "ogre_particles": row["particles"]}
        return beside | {"times_ogre": row["ms_median"] / ours["ms_median"], "cpu_over_ogre": share}
    if workload not in OGRE_WORKLOADS:
        return {}
    more = ["--data", str(folder), "--frames", str(args.frames), "--warmup", str(args.warmup), "--n", str(args.n)]
    ogre = measure_ogre(workload, args.size, _say, msaa=args.msaa or 0, more=more)
    return {} if ogre is None else {"ogre_ms": ogre, "times_ogre": ogre / ours["ms_median"]}


def _measure_realtime(args: argparse.Namespace) -> dict[str, Any]:
    """Measure the lateness of the three loops under the same load, one after the other, each in its own process."""
    seconds = _seconds(args, _SECONDS, _ALL_SECONDS)
    rounds: dict[str, list[dict[str, Any]]] = {kind: [] for kind in _KINDS}
    for number in range(args.rounds):
        for kind in _KINDS:
            sys.stderr.write(f"round {number + 1} of {args.rounds}: {kind}, {seconds:g} s\n")
            rounds[kind].append(_measure_apart(kind, args.scene, seconds))
    return {kind: _median_round(rows) for kind, rows in rounds.items()}


def _measure_apart(kind: str, scene: Path, seconds: float) -> dict[str, Any]:
    """Measure one loop, with the `stalls` of the machine meanwhile where they can be seen."""
    from mimics_app.app.bench.stall_witness import StallWitness, summarise

    command = [sys.executable, "-m", "mimics_app.app.bench.realtime_load", kind, str(scene), str(seconds)]
    witness = StallWitness()
    try:
        child = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    finally:
        stalls = witness.stop()
    if child.returncode != 0:
        raise DeviceError(
            f"the measurement of {kind} failed with exit code {child.returncode}", "see the messages above"
        )
    row: dict[str, Any] = json.loads(child.stdout)
    return row if stalls is None else row | {"stalls": summarise(stalls)}


def _median_round(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the round of median missed share: the figures of one real run, not a mixture."""
    counted = [row for row in rows if "missed_share" in row] or rows
    return sorted(counted, key=lambda row: float(row.get("missed_share", 0.0)))[len(counted) // 2]


def _measure_methods(args: argparse.Namespace) -> dict[str, Any]:
    """Measure cost and error of every registered method."""
    from mimics_app.lab.catalogue import load_methods
    from mimics_app.lab.measure import as_dict, measure

    registry = load_methods()
    return {"groups": applicable({group: as_dict(measure(group, registry)) for group in registry.groups()})}


def _measure_audio(args: argparse.Namespace) -> dict[str, Any]:
    """Measure the mixers beside peers, and the latency from contact to sample through a private PulseAudio sink."""
    if args.soak:
        from mimics_app.app.bench.audio_soak import measure_soak

        return measure_soak(args.scene, _seconds(args, _SECONDS, _SECONDS))
    from mimics_app.lab.audio_bench import measure_audio

    figures = measure_audio(_say, _seconds(args, _AUDIO_SECONDS, _AUDIO_SECONDS), _peers())
    if args.charts is not None:
        from mimics_app.lab.audio_figures import draw_figures

        figures["charts"] = draw_figures(args.charts)
    return figures


def _seconds(args: argparse.Namespace, usual: float, among_all: float) -> float:
    """Return `--seconds`, or else the usual length; limited to `among_all` where everything is measured."""
    return min(args.seconds or usual, among_all) if args.what == "all" else args.seconds or usual


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def _peers() -> Path | None:
    """Return the folder of the peers' harnesses, None where it is not set."""
    return _folder_of("PEERS")


def _folder_of(variable: str) -> Path | None:
    """Return the folder that an environment variable names, None where it is not set."""
    return Path(os.environ[variable]) if os.environ.get(variable) else None


def _measure_haptic(_: argparse.Namespace) -> dict[str, Any]:
    """Measure shapes, meshes and bodies beside a reference loop and peers; PEERS is a folder of further ones."""
    from mimics_app.lab.haptic_bench import measure_haptic

    return measure_haptic(_say, _peers())


def _measure_frame(args: argparse.Namespace) -> dict[str, Any]:
    """Measure whole frames of live sessions, with everything on."""
    from mimics_app.app.bench.frame_bench import measure_frames

    seconds = _seconds(args, _FRAME_SECONDS, _ALL_FRAME_SECONDS)
    scenes = [Path(name) for name in args.names]
    figures = measure_frames(scenes, args.size, args.surface, seconds, _say, args.scale, args.rounds)
    if args.charts is not None:
        from mimics_app.app.bench.frame_counts import draw_counts

        figures["charts"] = [draw_counts(args.charts)]
    return figures


def _measure_software(args: argparse.Namespace) -> dict[str, Any]:
    """Measure what each part of drawing in software saves."""
    from mimics_app.app.bench.software_bench import measure_software

    return measure_software([Path(name) for name in args.names], args.size, args.frames, _say)


def _measure_displays(args: argparse.Namespace) -> dict[str, Any]:
    """Measure stereo in one pass against two, and the latency from head pose to submitted frame."""
    from mimics_app.app.bench.display_bench import measure_displays

    return measure_displays(args.scene, args.size, args.frames, _say)


def _measure_record(args: argparse.Namespace) -> dict[str, Any]:
    """Measure what the recording of a killed session lacks."""
    from mimics_app.app.bench.record_bench import measure_record
    from mimics_app.app.scenes.scene_search import find_scene

    return measure_record(find_scene(args.scene), args.n or _REPEATS, _say)


def _measure_faults(args: argparse.Namespace) -> dict[str, Any]:
    """Measure the time from each fault of a device to zero force, and what faults of processes leave."""
    from mimics_app.app.bench.fault_bench import measure_faults
    from mimics_app.app.scenes.scene_search import find_scene

    return measure_faults(find_scene(args.scene), args.n or _REPEATS, _say, args.names)


def _measure_console(args: argparse.Namespace) -> dict[str, Any]:
    """Measure STOP, rate and cost of the operator's page, and what it does to the haptic loop."""
    from mimics_app.app.bench.console_bench import measure_console
    from mimics_app.app.scenes.scene_search import find_scene

    return measure_console(find_scene(args.scene), args.n or _PRESSES, args.rounds, _say)


def _measure_lokomat(args: argparse.Namespace) -> dict[str, Any]:
    """Measure the control of the gait orthosis: cost, wall, transparency, and the search of the obstacle sequence."""
    from mimics_app.lab.lokomat_bench import measure_lokomat

    figures = measure_lokomat(_say)
    if args.charts is not None:
        from mimics_app.lab.lokomat_figure import write_figures

        figures["charts"] = write_figures(args.charts)
    return figures


def _measure_physio(args: argparse.Namespace) -> dict[str, Any]:
    """Measure R peaks on annotated records and under noise, cost and latency; PEERS is the folder of peers' harnesses.

    With names only these: figures, written to `--charts`, or the table of R peaks by kind of noise.
    """
    if args.people is not None:
        from mimics_app.lab.physio.load_sessions import write_shipped_people

        write_shipped_people(args.people)
        return {"people": str(args.people)}
    from mimics_app.lab.physio.bench import measure_noise, measure_physio

    folder, names = args.data or _folder_of("PHYSIO_DATA"), _physio_figures(args)
    if _NOISE in args.names and folder is None:
        raise UsageError(
            "noise is added to annotated records: their folder is missing", "mimics bench physio noise --data DIR"
        )
    figures: dict[str, Any] = {"noise": measure_noise(folder)} if _NOISE in args.names else {}
    if not args.names:
        figures = measure_physio(folder, _peers())
    if args.charts is not None and names:
        from mimics_app.lab.physio_figures import draw_figures

        figures["charts"] = draw_figures(args.charts, names, folder)
    return figures


def _physio_figures(args: argparse.Namespace) -> list[str]:
    """Return the names of the requested figures; all of them where none is requested.

    Raises:
        UsageError: There is no figure of a name, or no folder to write the figures to.
    """
    from mimics_app.lab.physio_figures import FIGURES

    wanted = [name for name in args.names if name != _NOISE]
    unknown = [name for name in wanted if name not in FIGURES]
    if unknown:
        raise UsageError(f"bench physio has no figure {unknown[0]}", f"it has {_NOISE}, {', '.join(FIGURES)}")
    if wanted and args.charts is None:
        raise UsageError(f"no folder for the figure {wanted[0]}", f"mimics bench physio {wanted[0]} --charts DIR")
    return wanted if args.names else list(FIGURES)


_NOISE = "noise"
"""Name of the table of R peaks by kind of noise (`mimics bench physio noise`)."""

_MEASURES = {
    "realtime": _measure_realtime,
    "methods": _measure_methods,
    "audio": _measure_audio,
    "haptic": _measure_haptic,
    "physio": _measure_physio,
    "frame": _measure_frame,
    "software": _measure_software,
    "displays": _measure_displays,
    "record": _measure_record,
    "faults": _measure_faults,
    "console": _measure_console,
    "lokomat": _measure_lokomat,
}
