"""Collisions without rounding: fractions, formulas, and the cells where they hold.

A formula is the history of a run on traced fractions. Where to begin: `traced_fraction`
and `exact_run`, the run; `exact`, which reads its results as fractions. `symbolic_row`
gives names to numbers, `conditions` (with `contact_phases` and `separation`) says for
which other numbers the collision goes the same way. `formula` evaluates both in
symbols, with `rational_functions`; `atlas` evaluates them in floats, all over the plane
of two numbers.
"""
