"""Native loops of the solvers of constraints."""
