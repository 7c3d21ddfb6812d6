"""The compiled part of spatialgeometry's tree, which this package does not offer: importing it says what to use."""

from ulna.compat.missing_names import missing_module

raise missing_module(__name__)
