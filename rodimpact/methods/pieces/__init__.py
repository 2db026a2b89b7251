"""The method "characteristics": waves as polynomial pieces, contacts as small equations."""
