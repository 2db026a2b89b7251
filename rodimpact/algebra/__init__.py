"""Collisions without rounding: fractions, formulas, the cells where they hold, derivatives."""
