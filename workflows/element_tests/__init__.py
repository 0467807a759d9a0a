"""Laboratory tests of a soil of a case: paths, key figures, table and picture."""
