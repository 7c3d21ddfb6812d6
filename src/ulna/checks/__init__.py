"""Checks of the arguments that users pass: `values` for single values, `arrays` for arrays of numbers.

Each check takes the name of the argument first, so that messages can say which one is wrong, and returns the value in
the form that the caller works with. Inner loops do not call them.
"""
