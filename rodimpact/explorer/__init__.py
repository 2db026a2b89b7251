"""A page to see a collision and play with it, in one file that solves by itself.

The page holds no physics of its own. `tables`, `fronts` and `picture` are plain Python
around the kernels of fronts: from a case to its polygons, curves and texts. `solver`
makes JavaScript of them, kernels and all.
"""
