"""Wire form of curve coefficients."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Annotated, Self

from pydantic import Field

from design.analysis.warnings import DesignWarning
from design.curve_fit.fit_range import MAX_DEGREE, FitRange, Form
from design.curve_fit.fit_range import Field as PlantField
from design.curve_fit.polynomials import Fit
from design.errors import InvalidInputError
from schemas.actuators import ActuatorIn
from schemas.base import Wire, wire_names
from schemas.plants import PlantIn
from schemas.shapers import ShaperIn
from schemas.varied import VariedInRequest
from schemas.warnings import WarningOut, Warnings

FIELDS: dict[str, PlantField] = {
    "/plant/natural_frequency_rad_s": "natural_frequency_rad_s",
    "/plant/modes/0/natural_frequency_rad_s": "natural_frequency_rad_s",
    "/plant/cable_length_m": "cable_length_m",
    "/plant/damping_ratio": "damping_ratio",
    "/plant/modes/0/damping_ratio": "damping_ratio",
}
"""Fields that can be fitted over, as JSON pointers into the request."""


class FitIn(VariedInRequest):
    """Over which field to fit, and how well."""

    over: Annotated[
        str, Field(description=f"JSON pointer of the field, one of {', '.join(FIELDS)}.")
    ]
    from_: Annotated[float, Field(alias="from", ge=0, description="Start, in the field's unit.")]
    to: Annotated[float, Field(gt=0, description="End, in the field's unit.")]
    degree: Annotated[
        int | None, Field(ge=0, le=MAX_DEGREE, description="Degree of the polynomials.")
    ] = None
    max_residual: Annotated[
        float | None,
        Field(
            gt=0,
            lt=1,
            description="In place of degree: the largest residual that the fitted "
            "times may have [-].",
        ),
    ] = None
    form: Annotated[
        Form,
        Field(
            description="Form of the curves; time_in_frequency is that of the thesis, "
            "for comparison."
        ),
    ] = "dimensionless"

    def to_design(self, plant_kind: str) -> FitRange:
        """Build the design record for a plant of a kind.

        Parameters
        ----------
        plant_kind
            The plant's ``kind`` on the wire.

        Returns
        -------
        FitRange
            Range, degree and form of the fit.

        Raises
        ------
        InvalidInputError
            If such a plant has no field of that name.
        """
        in_list = plant_kind == "modes"
        if self.over not in FIELDS or self.over.startswith("/plant/modes/") != in_list:
            served = [one for one in FIELDS if one.startswith("/plant/modes/") == in_list]
            raise InvalidInputError(
                "over",
                self.over,
                f"one of {', '.join(served)}",
                code="not_a_number_of_plant",
            )
        return FitRange(
            over=FIELDS[self.over],
            start=self.from_,
            stop=self.to,
            degree=self.degree,
            max_residual=self.max_residual,
            form=self.form,
        )


@contextmanager
def name_fit(outer: str = "") -> Iterator[None]:
    """Name the field in which a fit finds a fault, from the request on.

    Parameters
    ----------
    outer
        Field of the request that holds plant, actuator and shaper; empty for the request itself.

    Raises
    ------
    InvalidInputError
        The fault of the body, its path led on from ``fit`` or from ``outer``.
    """
    try:
        yield
    except InvalidInputError as error:
        if error.path[0] in wire_names(FitIn):
            raise error.within("fit") from None
        raise (error.within(outer) if outer else error) from None


class FitDesign(Wire):
    """What was fitted."""

    plant: PlantIn
    actuator: ActuatorIn
    shaper: ShaperIn


class FitRequest(FitDesign):
    """Body of `POST /v1/fits`."""

    fit: Annotated[FitIn, Field(description="Field, range and degree of the fit.")]


class VariableOut(Wire):
    """The variable of the polynomials."""

    name: Annotated[str, Field(description="Name of the variable in the formula.")]
    is_: Annotated[str, Field(alias="is", description="Quotient or field that it stands for.")]
    from_: Annotated[float, Field(alias="from", description="Least value that is served.")]
    to: Annotated[float, Field(description="Largest value that is served.")]


class FitOut(Wire):
    """Curve coefficients, with their residual."""

    variable: Annotated[VariableOut, Field(description="Variable of the polynomials.")]
    value: Annotated[
        str, Field(description="What the polynomials give: a time, or a product with one.")
    ]
    coefficients: Annotated[
        list[list[float]], Field(description="A row for each impulse, in ascending powers of x.")
    ]
    degree: Annotated[int, Field(description="Degree of the polynomials.")]
    worst_timing_error_s: Annotated[
        float, Field(description="Largest error of a fitted time over the range [s].")
    ]
    worst_residual: Annotated[
        float, Field(description="Largest residual of the fitted times over the range [-].")
    ]
    checked_points: Annotated[
        int, Field(description="Points of the range at which both were checked.")
    ]
    formula: Annotated[str, Field(description="How times follow from the coefficients.")]
    design: Annotated[FitDesign, Field(description="The design that was fitted.")]
    warnings: Warnings

    @classmethod
    def from_design(cls, fit: Fit, design: FitDesign, warnings: Iterable[DesignWarning]) -> Self:
        """Wrap the design record.

        Parameters
        ----------
        fit
            The polynomials.
        design
            The request that they belong to.
        warnings
            What to know of them.

        Returns
        -------
        Self
            With coefficients, errors and the request.
        """
        return cls(
            variable=VariableOut.model_validate({
                "name": fit.variable.name,
                "is": fit.variable.meaning,
                "from": fit.variable.start,
                "to": fit.variable.stop,
            }),
            value=fit.value,
            coefficients=fit.coefficients.tolist(),
            degree=fit.degree,
            worst_timing_error_s=fit.worst_timing_error_s,
            worst_residual=fit.worst_residual,
            checked_points=fit.checked_points,
            formula=fit.formula,
            design=design,
            warnings=[WarningOut.from_design(one) for one in warnings],
        )
