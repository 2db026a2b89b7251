"""Methods: each takes a `Row`, hands back a `Run`, and knows nothing of solutions."""
