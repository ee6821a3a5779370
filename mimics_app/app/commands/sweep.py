"""`mimics sweep SPEC.json`: compute an experiment at many points, in chunks that survive a crash, as Parquet."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.app.terminal.arguments import file_to_write, whole_number
from mimics_app.app.terminal.output import answer

if TYPE_CHECKING:
    from mimics_app.app.sweep.worker import SweepJob
    from mimics_app.lab.sweep.quantity import SweepExperiment
    from mimics_app.lab.sweep.store import Chunk

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics sweep`."""
    parser.add_argument(
        "spec", type=Path, nargs="?", help="sweep file (.json), such as docs/sweeps/wall_stability.json"
    )
    parser.add_argument("--list", action="store_true", help="list the experiments, their parameters and results")
    parser.add_argument(
        "--out", type=file_to_write, metavar="FILE", help="Parquet file to write (default: runs/sweeps/NAME.parquet)"
    )
    parser.add_argument(
        "--workers",
        type=whole_number("number of processes", range(1, 1025)),
        metavar="N",
        help="number of processes (default: one for each core)",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        default="",
        help="compute on the Dask scheduler at this address, instead of in processes",
    )


def run(args: argparse.Namespace) -> int:
    """Compute the missing chunks and join all of them; or list the experiments."""
    from mimics_app.contracts.errors import UsageError

    if (args.spec is None) != args.list:
        raise UsageError("give either a sweep file or --list", "see mimics sweep --help")
    return _list(args) if args.list else _sweep(args)


def _list(args: argparse.Namespace) -> int:
    """Print the experiments with their parameters and results."""
    from mimics_app.app.sweep.experiments import NAMES, find_experiment

    experiments = [experiment for name in NAMES if (experiment := find_experiment(name)) is not None]
    lines = (line for experiment in experiments for line in _lines(experiment))
    answer(args, {"experiments": [experiment.as_dict() for experiment in experiments]}, lines)
    return 0


def _lines(experiment: SweepExperiment) -> Iterator[str]:
    yield f"{experiment.name}: {experiment.what}"
    for name, quantity in experiment.parameters.items():
        yield f"  {name:18} {quantity}"
    if experiment.open_prefix:
        yield f"  {experiment.open_prefix + '*':18} a parameter of the scene's task"
    yield f"  results: {', '.join(experiment.results)}\n"


def _sweep(args: argparse.Namespace) -> int:
    """Compute the missing chunks and join all of them."""
    from mimics_app.app.sweep.experiments import NAMES, find_experiment
    from mimics_app.app.sweep.worker import SweepJob
    from mimics_app.app.terminal.progress import ProgressBar
    from mimics_app.contracts.errors import SceneError
    from mimics_app.lab.sweep.points import count_points
    from mimics_app.lab.sweep.spec import load_sweep, span_of
    from mimics_app.lab.sweep.store import ChunkStore, chunks_of, source_digest

    sweep = load_sweep(args.spec, find_experiment, NAMES)
    sources = source_digest()
    job = SweepJob(sweep.canonical, str(args.spec.resolve().parent), sources)
    issues, files = job.experiment.check(span_of(sweep), args.spec)
    if issues:
        raise SceneError(issues)
    out = args.out or Path("runs") / "sweeps" / args.spec.with_suffix(".parquet").name
    points = count_points(sweep)
    chunks = chunks_of(points, sweep.chunk or job.experiment.chunk)
    store = ChunkStore(out, f"{sweep.digest}/{sources}/{files}")
    missing = [chunk for chunk in chunks if not store.has(chunk)]
    with ProgressBar(sys.stderr, len(chunks), len(chunks) - len(missing)) as bar:
        bar.step(f"{len(missing)} of {len(chunks)} chunks to compute")
        for chunk, data in _compute(missing, job, args):
            store.put(chunk, data)
            bar.step(f"of {len(chunks)} chunks")
    store.finish(chunks, sweep)
    counts = {"points": points, "pieces": len(chunks), "computed": len(missing)}
    line = f"{points} points of {sweep.experiment} in {out}"
    answer(args, {"experiment": sweep.experiment, **counts, "out": out}, [line])
    return 0


def _compute(missing: list[Chunk], job: SweepJob, args: argparse.Namespace) -> Iterator[tuple[Chunk, bytes]]:
    from mimics_app.lab.sweep import executors

    if args.scheduler:
        return executors.compute_on_scheduler(missing, job, args.scheduler)
    workers = min(args.workers or os.cpu_count() or 1, len(missing))
    if workers <= 1:
        return executors.compute_here(missing, job)
    return executors.compute_in_processes(missing, job, workers)
