"""Records of laboratories: signals, how they are read, measured and compared."""
