"""What every algorithm stands on: recursions over the tree, link frames, mass moments, references, forces on bodies."""
