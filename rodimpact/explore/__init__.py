"""See a collision and play with it: a local page, and the same page in one file to hand out.

The page holds no physics of its own. `tables`, `fronts` and `picture` are plain Python around the
kernels of fronts: from a case to its polygons, curves and texts. `solver` makes JavaScript of them,
kernels and all, and the page solves with it what fronts can carry, served or from a file. What else
there is, the server solves, samples, and shows with the same `picture`. So the scene has one source
in a language that tests, figures and the page share, and a slider need not wait for a server.
"""
