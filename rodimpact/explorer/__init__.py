"""A page to see a collision and play with it, in one file that solves by itself.

Begin with `exploring`, which makes the page, and with `solved`, which leads from the
tables of a case to all that the page shows. `tables` makes the system of the tables,
`fronts` and `pieces` run the kernels of the two methods, and `facts`, `motion`,
`picture` and `reason` make numbers, curves and texts of their runs. The page has no
physics of its own: `solver` translates these modules to JavaScript with `javascript`,
and `page_files` puts the translation and the files of ``page/`` together. There, begin
with ``main.js``.
"""
