"""Methods: each takes a `Row`, and returns a `Run`, from which a `Solution` is made."""
