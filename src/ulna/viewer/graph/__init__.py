"""The scene graph: nodes with poses and appearances, what they hold, the camera, and the handles of nodes."""
