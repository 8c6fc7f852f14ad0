"""The scene: one file a group of things that are drawn; all render from the state or follow the frames."""
