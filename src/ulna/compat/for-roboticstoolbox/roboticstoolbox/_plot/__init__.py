"""Pictures of robots in matplotlib and in the viewer."""
