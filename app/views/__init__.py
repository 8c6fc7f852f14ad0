"""The panels and the scene: one file each, rendered from the state; none holds any."""
