"""Answers: those of the wire, with arrays, pictures and tables."""

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, Self, cast

import numpy as np
from pydantic import BaseModel

from design.errors import DesignError
from design.types import FloatArray
from schemas.base import Wire
from schemas.designs import DesignResponse
from schemas.fits import FitOut, FitRequest
from schemas.impulses import ImpulsesWire
from schemas.maneuvers import ManeuverResponse
from schemas.maps import MapResponse
from schemas.recommendations import RecommendationResponse
from schemas.runs import RunResponse
from schemas.sensitivity import SensitivityResponse
from schemas.simulations import SimulationResponse
from schemas.table_jobs import TableJob
from service.operations.table import load
from service.problems import SOLVER_FAILED, Problem, problem_of_design
from shapersmith.errors import raise_problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from service.cli.rendering import Response


def require_done(job: TableJob) -> TableJob:
    """Return a table job that is done; of any other, raise its problem."""
    if job.state != "done":
        raise_problem(Problem(SOLVER_FAILED, job.reason or f"the table is {job.state}").document())
    return job


class Result(Wire):
    """An answer: printed it is the text of the command line, in a notebook a table.

    Attributes
    ----------
    OPERATION
        Name of the operation that answers so.
    """

    OPERATION: ClassVar[str]

    _request: bytes = b""

    @classmethod
    def of(cls, answer: BaseModel | bytes, request: bytes) -> Self:
        """Return an answer together with its request.

        Parameters
        ----------
        answer
            What the operation answers, as a model or as JSON.
        request
            What it was asked, as JSON.

        Returns
        -------
        Self
            The answer, field by field.
        """
        if isinstance(answer, bytes):
            made = cls.model_validate_json(answer)
        else:
            made = cls.model_construct(**dict(answer))
        made._request = request
        return made

    def to_dict(self) -> dict[str, Any]:
        """Return the answer as JSON has it."""
        return self.model_dump(mode="json", by_alias=True)

    def plot(self) -> "Figure":
        """Return the picture that ``--plot`` writes, computed here anew."""
        case = load(self.OPERATION)
        return case.draw(case.request.model_validate_json(self._request))

    def __str__(self) -> str:
        from service.cli.rendering import as_table  # noqa: PLC0415

        return as_table(cast("Response", self), self._request).rstrip()

    def _repr_html_(self) -> str:
        from service.cli.rendering import as_html  # noqa: PLC0415

        return as_html(cast("Response", self), self._request)


class Stepped(Result):
    """An answer with the steps of a command."""

    @property
    @abstractmethod
    def steps(self) -> ImpulsesWire:
        """Steps of the command."""

    @property
    def times_s(self) -> FloatArray:
        """Times of the steps, shape (n,) [s]."""
        return np.array(self.steps.times_s)

    @property
    def amplitudes(self) -> FloatArray:
        """Heights of the steps, shape (n,), shares of full speed [-]."""
        return np.array(self.steps.amplitudes)


class Design(Stepped, DesignResponse):
    """One shaper, proven."""

    OPERATION = "design"

    @property
    def steps(self) -> ImpulsesWire:
        """Impulses of the shaper."""
        return self.shaper.impulses


class Maneuver(Stepped, ManeuverResponse):
    """A whole move from rest to rest."""

    OPERATION = "maneuver"

    @property
    def steps(self) -> ImpulsesWire:
        """Steps of the whole move."""
        return self.command


class Recommendation(Stepped, RecommendationResponse):
    """The fastest shaper that meets what is required, and the others."""

    OPERATION = "recommendation"

    @property
    def steps(self) -> ImpulsesWire:
        """Impulses of the recommended shaper."""
        return self.recommended.impulses


class Simulation(Result, SimulationResponse):
    """The motion under a command."""

    OPERATION = "simulation"

    @property
    def history(self) -> dict[str, FloatArray]:
        """The motion by name, times among it, each an array of shape (n,)."""
        names = ("times_s", "command_m_s", "velocity_m_s", "deflection_m", "angle_rad")
        told = {name: getattr(self, name) for name in names}
        return {name: np.array(values) for name, values in told.items() if values is not None}


class Run(Result, RunResponse):
    """The crane, driven by events."""

    OPERATION = "run"

    @property
    def log(self) -> dict[str, FloatArray]:
        """The columns of its log by name, times among them, each of shape (n,)."""
        from service.cli.run_log import log_columns  # noqa: PLC0415

        return {name: np.array(values) for name, values in log_columns(self).items()}


class Sensitivity(Result, SensitivityResponse):
    """A sensitivity curve."""

    OPERATION = "sensitivity"


class Fit(Result, FitOut):
    """Curve coefficients of a shaper."""

    OPERATION = "fit"

    def times_s(self, values: float | FloatArray) -> FloatArray:
        """Return the times of the impulses by the fitted curves.

        Parameters
        ----------
        values
            One value of the field that was fitted over, or several, shape (m,), in its SI unit.

        Returns
        -------
        FloatArray
            Shape (n,), or (m, n) [s].

        Raises
        ------
        InvalidInputError
            If a value is outside the range of the fit.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Pendulum(cable_length_m=0.8)
        >>> lengths = shapersmith.FitRange(
        ...     over="/plant/cable_length_m", from_=0.5, to=1, degree=3
        ... )
        >>> drive = shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
        >>> shapersmith.fit(crane, drive, "numzv", lengths).times_s(0.8).round(4).tolist()
        [0.0, 0.3385, 0.5837]
        """
        from design.curve_fit.evaluation import times_by_curves  # noqa: PLC0415

        asked = FitRequest.model_validate_json(self._request)
        try:
            times_s = times_by_curves(
                asked.plant.to_design(),
                asked.actuator.to_design(),
                asked.fit.to_design(asked.plant.kind),
                np.array(self.coefficients),
                np.atleast_1d(np.asarray(values, dtype=np.float64)),
            )
        except DesignError as error:
            raise_problem(problem_of_design(error).document())
        return times_s if np.ndim(values) else times_s[0]


class FieldMap(Result, MapResponse):
    """A quantity over one or two fields."""

    OPERATION = "map"

    @property
    def values(self) -> FloatArray:
        """The quantity in every cell, NaN where there is no shaper or move.

        Shape (y, x), of a curve (x,); of ``times_s`` and ``branch`` (y, x, k), or (x, k).
        """
        cells = getattr(self, self.quantity)
        if self.quantity not in {"times_s", "branch"}:
            return np.array(cells, dtype=np.float64)
        rows = [[cell or [] for cell in row] for row in (cells if self.y else [cells])]
        widest = max(len(cell) for row in rows for cell in row)
        filled = np.full((len(rows), len(self.x.values), widest), np.nan)
        for place in np.ndindex(filled.shape[:2]):
            cell = rows[place[0]][place[1]]
            filled[place][: len(cell)] = cell
        return filled if self.y else filled[0]
