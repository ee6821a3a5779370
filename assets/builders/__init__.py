"""Builders of the shipped content: each package with a module `build` is one, and all have one interface.

`compose(seed)` returns the bytes of files by their names: the same seed gives the same content, and nothing
is written. `mimics assets build NAME` writes them; `--picture` draws its models from all sides for inspection.
"""

__all__: list[str] = []
