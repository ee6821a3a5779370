"""What makes the shipped content. Each package with a module `build` is a builder, and all have one habit.

`compose(seed)` gives the bytes of files by their names: the same seed makes the same bytes on any machine, and nothing
is written. `mimics assets build NAME` writes them, and `--picture` draws its models from all sides, to be looked at.
"""

__all__: list[str] = []
