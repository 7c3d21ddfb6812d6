"""Mutation sampling: mutants of the sources, the tests that cover them, and their trials."""
