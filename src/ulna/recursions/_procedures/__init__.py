"""Procedures: the recursions themselves. Their arrays are described in `tree_table`, and in the modules."""
