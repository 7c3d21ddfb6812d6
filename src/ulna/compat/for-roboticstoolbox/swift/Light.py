"""The lights of Swift, which this package does not offer: importing them says what to use."""

from ulna.compat.missing_names import missing_module

raise missing_module(__name__)
