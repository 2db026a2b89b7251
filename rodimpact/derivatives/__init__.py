"""Exact derivatives of what a collision adds up to."""
