"""A simulated person's body: latent state, raw signals, and the source that plays them. Import submodules by name."""

__all__: list[str] = []
