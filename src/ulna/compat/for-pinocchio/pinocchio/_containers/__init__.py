"""Lists, enumerations, argument checks and files that all parts of the package share."""
