"""One module per subcommand, imported only when it is called.

Each has `add_arguments(parser: argparse.ArgumentParser) -> None` and `run(args: argparse.Namespace) -> int` (the exit
code). `--json` is added by the command line itself; a command checks `args.json` and calls `write_object` of
`app.terminal.output`. Errors are raised as `contracts.errors`, never printed. Heavy imports belong inside the
functions, so that `mimics NAME --help` is quick too.
"""

__all__: list[str] = []
