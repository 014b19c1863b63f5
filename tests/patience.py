"""How long tests wait for what is not judged by time."""

PATIENT_S = 1200.0
"""Ends what hangs; nothing is judged by it [s].

A machine that is busy with other things is six times slower, and table jobs, which yield to all
others, more than that.
"""
