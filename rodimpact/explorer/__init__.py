"""See a collision and play with it: one page, which solves by itself and asks nobody for anything.

The page holds no physics of its own. `tables`, `fronts` and `picture` are plain Python around the
kernels of fronts: from a case to its polygons, curves and texts. `solver` makes JavaScript of them,
kernels and all.
"""
