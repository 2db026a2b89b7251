"""See a collision and play with it: a local page, and the same page in one file to hand out.

The page holds no physics. A `Design` comes from its controls, `scene` turns what was solved into
polygons, curves and texts, and the page draws them.
"""
