"""Collision checks by spheres in machine code, many configurations in SIMD lanes: for batches and for planning."""
