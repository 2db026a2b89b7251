"""Collisions without rounding: fractions, formulas, and the cells where they hold."""
