"""Collisions without rounding: rational results, formulas, and the cells in which they hold."""
