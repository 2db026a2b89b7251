"""A page to see a collision and play with it, in one file that solves by itself.

The page has no physics of its own. The modules `tables`, `solved`, `fronts`, `pieces`,
`motion`, `picture` and `reason` lead from the tables of a case to polygons, curves and
texts, with the kernels of the methods. `solver` translates all of them to JavaScript.
"""
