"""Seeing robots: a scene that does not care who draws it, a page in the browser, and pictures without one.

Nothing here is imported by `import ulna`. `show` opens a page; `render` and `write_png` make a picture with
NumPy alone.
"""
