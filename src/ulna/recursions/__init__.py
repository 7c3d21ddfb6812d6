"""Recursions over a table of joints, in loops: one machine code for all models, whose size their joints do not decide.

Large robots use them instead of the straight-line code that is traced for one model; see docs/compiler.md.
"""
