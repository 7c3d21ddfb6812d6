"""Recipes: how algorithms become kernels, by theme; `ulna.kernels` looks them up."""
