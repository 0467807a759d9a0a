"""Results of a throw-away prototype for the paper's Figs 6 and 8: no external reference.

The paper prints pictures and no numbers.  The prototype was written from the paper independently of
this code and then thrown away; it has the same scheme (linear triangles with alternating diagonals,
four material points each as quadrature, mesh moved by eqs 1-2).  Agreement shows that two programs
solve the same equations, not that the equations are right.

Soil 5 m x 15 m, E = 10 kPa, nu = 0, no weight; pile x < 1 m, tip at 8 m depth, 40 steps of 0.1 m.
Upward reaction on the modelled half of the pile in N per metre run by step number.  Without weight
it is proportional to E.
"""

from __future__ import annotations

YOUNGS_MODULUS = 10e3
"""Of all results, in Pa."""

NO_SLIP = {
    (0.5, False): {
        1: 586.9, 5: 3142.0, 10: 6774.6, 15: 10950.0, 20: 15739.8, 25: 21496.0, 30: 28584.1,
        35: 37159.0, 40: 47125.8,
    },
    (0.25, False): {1: 583.9, 10: 6503.2, 20: 15033.7, 30: 27259.4, 40: 40249.0},
    (0.5, True): {1: 1440.7, 10: 14645.5, 20: 29775.3, 30: 45752.3, 40: 60931.0},
}  # fmt: skip
"""Fig. 6, by size of the squares in m and whether the outer side is fixed (else a roller)."""

NO_SLIP_SURFACE = (10.99, 11.04, 11.23, 11.27, 11.41, 11.43, 11.48, 11.49)
"""Fig. 6, size 0.5 m, roller, at the end: the highest point of each half metre, from the pile.

In m above the bottom.
"""

ELASTIC_INTERFACE = {
    1e7: {1: 586.84, 10: 6775.9, 20: 15687.0, 30: 28499.0, 40: 46792.0},
    1e1: {1: 504.96, 10: 5586.2, 20: 12473.0, 30: 19886.0, 40: 29357.0},
}
"""Fig. 8, size 0.5 m, k_n = 1e8 Pa/m, by shear stiffness k_s in Pa/m."""

SMOOTH_SURFACE = (13.554, 13.570)
"""Fig. 8, k_s = 10 Pa/m, at the end: lowest and highest level of the surface in m."""
