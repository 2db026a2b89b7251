"""Fits of systems to measured records: what is unknown, and how well it is known then."""
