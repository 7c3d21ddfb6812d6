"""Dynamics: inverse and forward dynamics, the mass matrix, momentum, energy, regressors."""
