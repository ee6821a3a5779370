"""Drawing in software: what is done only where the processor fills the pixels; see `surfaces.rasteriser`."""

__all__: list[str] = []
