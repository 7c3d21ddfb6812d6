"""Model files and tables -> ModelBuilder: URDF, xacro, SRDF, Denavit-Hartenberg tables, chains of elementary transforms."""
