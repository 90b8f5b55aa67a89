"""Charts of studies: of designs, a duty, a free cycle, an identification."""
