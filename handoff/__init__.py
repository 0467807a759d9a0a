"""Stage 2: the installed ground, carried from material points to a finite-element model."""
