"""Entry point of the command `mimics`, and of `python -m mimics_app`."""

import sys

__all__ = ["main"]


def main() -> int:
    """Run the command line of this process; Ctrl-C while it is still being imported is an exit like any other.

    Returns:
        The exit code.
    """
    try:
        from mimics_app.app import cli

        return cli.main()
    except KeyboardInterrupt:
        sys.stderr.write("mimics: interrupted\n")
        return 130


if __name__ == "__main__":
    sys.exit(main())
