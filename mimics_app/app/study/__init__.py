"""Studies: the runs of several subjects as one tidy set of tables and one page."""

__all__: list[str] = []
