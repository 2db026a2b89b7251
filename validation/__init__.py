"""Numbers from elsewhere that rodimpact must reproduce: one file a case."""
