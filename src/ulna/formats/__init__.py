"""From model files and tables to models: URDF, xacro, SRDF, Denavit-Hartenberg, elementary transforms."""
