"""Imported by the fork server alone: what it has built, all workers that it forks are born with."""

from service.workers.solvers import warm_solvers

warm_solvers()
