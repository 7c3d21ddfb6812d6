"""Methods of traced functions beside calls: derivatives, packed matrices, pictures."""
