"""The base of all algorithms: recursions over the tree, link frames, mass moments, references, forces on bodies."""
