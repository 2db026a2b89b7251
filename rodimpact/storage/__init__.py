"""What is kept in files, and texts for people and programs."""
