"""From model files and tables to models: URDF, xacro, MJCF, SRDF, Denavit-Hartenberg, elementary transforms."""
