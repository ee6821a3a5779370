"""Exporters of recordings, one module each with `EXPORTER`; those of installed packages are found by entry point."""

__all__: list[str] = []
