"""The module of that name, which holds nothing in spatialgeometry either."""
