"""Published times of shapers for an ideal actuator, by the damping ratio."""

ZV_POLYNOMIALS = (
    (0.16724, 0.27242, 0.20345, 0.0),
    (0.33323, 0.00533, 0.17914, 0.20125),
)
"""UMZV times over T, rows t2 and t3, ascending powers of the damping ratio [1]_."""

ZVD_POLYNOMIALS = (
    (0.08945, 0.28411, 0.23013, 0.16401),
    (0.36613, -0.08833, 0.24048, 0.17001),
    (0.64277, 0.29103, 0.23262, 0.43784),
    (0.73228, 0.00992, 0.49385, 0.38633),
)
"""UMZVD times over T, rows t2 to t5, ascending powers of the damping ratio [1]_.

References
----------
.. [1] W. Singhose, W. Seering, N. Singer, "Time-optimal negative input shapers", J. Dyn. Sys.,
   Meas., Control 119 (1997); Kim 2011, table 3-1.
"""
