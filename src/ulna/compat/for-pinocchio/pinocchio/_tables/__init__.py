"""Algorithms as loops over a table of joints: one machine code for all models, which first calls of a model use."""
