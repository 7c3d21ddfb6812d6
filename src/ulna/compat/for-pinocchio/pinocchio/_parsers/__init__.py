"""Models and geometries from files, and sample models."""
