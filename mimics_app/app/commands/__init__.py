"""One module per subcommand, imported only when it is called.

Each has `add_arguments(parser: argparse.ArgumentParser) -> None` and `run(args: argparse.Namespace) -> int` (the exit
code). `--json` is added by the command line itself; a command answers by `answer` of `app.terminal.output`: one object,
or lines of text. Errors are raised as `contracts.errors`, never printed. Heavy imports belong inside the functions, so
that `mimics NAME --help` is quick too.
"""

__all__: list[str] = []
