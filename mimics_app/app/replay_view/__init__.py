"""`mimics replay RUN --view` and `--video`: a recorded run to look at, at any time and from any view."""

__all__: list[str] = []
