"""Poses, tables of text, and the modules that names are imported from."""
