"""The method "fronts": every wave front from end to end, exact."""
