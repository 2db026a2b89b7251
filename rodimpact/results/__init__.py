"""What a run is read as: signals, fields, contacts, energy, outcome."""
