"""`mimics assets ACTION [NAME]`: what builds the shipped models and sounds, and building them anew."""

from __future__ import annotations

import argparse
from pathlib import Path

__all__ = ["add_arguments", "run"]

_MAX_SEED = 2**63 - 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("action", choices=("build", "list"), help="build: write the files of NAME; list: the names")
    parser.add_argument("name", nargs="?", default="", help="what to build")
    parser.add_argument("--seed", type=_seed, default=1, help="the same seed makes the same bytes on any machine")
    parser.add_argument("--out", type=Path, default=Path("."), metavar="DIR", help="folder of the files")


def run(args: argparse.Namespace) -> int:
    """List the builders, or run one."""
    from mimics_app.app import output
    from mimics_app.app.asset_builders import find_builder, find_builders
    from mimics_app.contracts.errors import UsageError

    if args.action == "list":
        builders = find_builders()
        if args.json:
            rows = [{"name": each.name, "what": each.what, "file": each.file} for each in builders]
            output.write_object("assets", {"builders": rows})
        else:
            for each in builders:
                print(f"{each.name:12} {each.what}")
        return 0
    if not args.name:
        raise UsageError("build what?", "mimics assets list names what can be built")
    files = find_builder(args.name).build(args.out, args.seed)
    if args.json:
        rows = [{"file": file, "bytes": file.stat().st_size, "sha256": _digest(file)} for file in files]
        output.write_object("assets", {"name": args.name, "seed": args.seed, "files": rows})
        return 0
    for file in files:
        print(f"{file}: {file.stat().st_size} bytes, sha256 {_digest(file)}")
    return 0


def _seed(text: str) -> int:
    if not (text.isdecimal() and int(text) <= _MAX_SEED):
        raise argparse.ArgumentTypeError(f"{text} is no whole number from 0 to 2^63 - 1")
    return int(text)


def _digest(file: Path) -> str:
    import hashlib

    return hashlib.sha256(file.read_bytes()).hexdigest()
