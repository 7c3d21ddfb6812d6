"""The version of Ulna."""

__version__ = "0.1.0"
