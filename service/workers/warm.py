"""Imported by the fork server alone: what it has built, all workers that it forks are born with."""

from service.workers.machine_code import load_machine_code
from service.workers.solvers import warm_solvers

load_machine_code()
warm_solvers()
