"""`mimics schema`: the JSON Schema of scene files, so that an editor completes keys and shows units."""

from __future__ import annotations

import argparse
import json
import sys

from mimics_app.app.terminal.arguments import file_to_write
from mimics_app.contracts.errors import OutputError

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--out", type=file_to_write, metavar="FILE", help="file to write, instead of stdout")


def run(args: argparse.Namespace) -> int:
    """Write the schema, plain or inside the object of `--json`."""
    import mimics_app.app.scenes.loading  # noqa: F401  registers the types of every stage
    from mimics_app.world.files.scene.schema import scene_schema

    schema = scene_schema()
    text = json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
    if args.out is not None:
        try:
            args.out.write_text(text, encoding="utf-8")
        except OSError as error:
            raise OutputError(args.out, f"cannot be written: {error.strerror}", "name another file") from None
    if args.json:
        from mimics_app.app.terminal.output import write_object

        write_object("schema", {"json_schema": schema})
    elif args.out is None:
        sys.stdout.write(text)
    return 0
