"""Fits of systems to measured records: best parameters and their uncertainty."""
