"""The calls, each an operation: arguments are the fields of its request, by name.

Longer than other modules: most of it says what each argument is, where an editor shows it.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeVar

from design.maps.map_case import Quantity
from design.model.actuators.model import Model
from design.moves.hoisting_moves import Retime
from design.recommendations.requirements import Sign
from design.rig.crane import CraneModel
from schemas.actuators import ActuatorIn
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.printed import FirmwareName
from schemas.shaper_request import ShaperRequest
from schemas.simulations import CommandIn
from shapersmith.given import (
    AngleSwing,
    Axis,
    DampingBand,
    DampingRange,
    DeflectionSwing,
    DriveRange,
    FitRange,
    Json,
    Move,
    SensitivityRange,
    as_json,
)
from shapersmith.results import (
    Design,
    FieldMap,
    Fit,
    Maneuver,
    Recommendation,
    Result,
    Run,
    Sensitivity,
    Simulation,
)

Plant = PlantIn | Json
Actuator = ActuatorIn | Json
Shaper = str | ShaperRequest | Json
"""Name of a kind, or what `shapersmith.shaper` makes of it with parameters."""

USUAL_CURVE = SensitivityRange()
"""The sensitivity curve that an answer has where nothing is said of it."""

Answered = TypeVar("Answered", bound=Result)


class Calls(ABC):
    """The operations of shapersmith.

    An argument may be an object as JSON has it, so that ``design(**request)`` takes the body of a
    request. Errors are `ShapersmithError`, with the code and the fields that HTTP names.
    """

    @abstractmethod
    def ask(self, answer: type[Answered], request: bytes) -> Answered:
        """Return the answer to a request.

        Parameters
        ----------
        answer, request
            Class of the answer, and the request as JSON.

        Returns
        -------
        Answered
            The answer.
        """

    def design(
        self,
        plant: Plant,
        actuator: Actuator,
        shaper: Shaper,
        *,
        sensitivity: SensitivityRange | Json | None = USUAL_CURVE,
        drive: DriveRange | Json | None = None,
        fit: FitRange | Json | None = None,
        trace: bool = False,
    ) -> Design:
        """Design one shaper and prove it.

        Parameters
        ----------
        plant, actuator
            What moves, and what drives it.
        shaper
            Kind of shaper.
        sensitivity
            Range of its sensitivity curve; None for no curve.
        drive
            By how much the drive may be off; None for no residual of such drives.
        fit
            Range of its curve coefficients; None for none.
        trace
            Whether to report each step of the search.

        Returns
        -------
        Design
            The shaper, its certificate and what was asked for with it.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
        >>> drive = shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
        >>> found = shapersmith.design(crane, drive, "numzv")
        >>> found.times_s.round(4), found.amplitudes
        (array([0.    , 0.3385, 0.5836]), array([ 1., -1.,  1.]))
        >>> found.certificate.verified
        True
        """
        return self._ask(
            Design,
            plant=plant,
            actuator=actuator,
            shaper=_shaper(shaper),
            sensitivity=sensitivity,
            drive=drive,
            fit=fit,
            trace=trace,
        )

    def recommend(
        self,
        plant: Plant,
        actuator: Actuator,
        *,
        half_width: float | None = None,
        lower_ratio: float | None = None,
        upper_ratio: float | None = None,
        tolerance: float = 0.05,
        damping: DampingBand | Json | None = None,
        max_duration_s: float | None = None,
        sign: Sign = "any",
        lowest_command: float = 0.0,
        highest_command: float = 1.0,
        max_high_mode_gain: float | None = None,
        sample_time_s: float | None = None,
        drive_off_by: float | None = None,
        firmware: FirmwareName | None = None,
    ) -> Recommendation:
        """Return the fastest shaper that meets what is required, and why.

        Parameters
        ----------
        plant, actuator
            What moves, and what drives it.
        half_width
            The frequency is within 1 - half_width and 1 + half_width of that of the plant; 0.15 if
            neither it nor the ratios are given [-].
        lower_ratio, upper_ratio
            In place of half_width: least and largest frequency over that of the plant [-].
        tolerance
            Largest residual over all that the plant may be [-].
        damping
            Which damping ratios the plant may have; None for that of the plant.
        max_duration_s
            Longest duration of a shaper [s].
        sign
            ``positive``, ``unity`` or ``any``: which amplitudes a shaper may have.
        lowest_command, highest_command
            Levels between which a shaped unit step stays [-].
        max_high_mode_gain
            Largest residual in any higher mode [-].
        sample_time_s
            Sample time of a controller [s].
        drive_off_by
            The tolerance holds as well where every parameter of the drive is off by this share [-].
        firmware
            Firmware of a printer, whose kinds alone are candidates; None for any.

        Returns
        -------
        Recommendation
            The shaper, the runners-up, and those that were refused.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01)
        >>> best = shapersmith.recommend(crane, shapersmith.Ideal(), half_width=0.1).recommended
        >>> best.worst_residual <= 0.05
        True
        """
        return self._ask(
            Recommendation,
            plant=plant,
            actuator=actuator,
            half_width=half_width,
            lower_ratio=lower_ratio,
            upper_ratio=upper_ratio,
            tolerance=tolerance,
            damping=damping,
            max_duration_s=max_duration_s,
            sign=sign,
            lowest_command=lowest_command,
            highest_command=highest_command,
            max_high_mode_gain=max_high_mode_gain,
            sample_time_s=sample_time_s,
            drive_off_by=drive_off_by,
            firmware=firmware,
        )

    def maneuver(
        self,
        plant: Plant,
        actuator: Actuator,
        shaper: Shaper,
        speed_m_s: float | None = None,
        *,
        pulse_s: float | None = None,
        distance_m: float | None = None,
        force_n: float | None = None,
        duration_s: float | None = None,
        initial: AngleSwing | DeflectionSwing | Json | None = None,
        joint: bool = False,
        retime: Retime | None = None,
        sample_time_s: float | None = None,
    ) -> Maneuver:
        """Design a whole move from rest to rest.

        Parameters
        ----------
        plant, actuator, shaper
            What moves, what drives it, and the kind of shaper.
        speed_m_s
            Full speed [m/s]; None for a free body.
        pulse_s, distance_m
            One of both: the time from the start to the stop [s], or the distance [m].
        force_n, duration_s
            For a free body: the largest force [N], and a time in which it is on as shortly as may
            be [s]; None for minimum time.
        initial
            Swing at the first step, to be cancelled; None for a load at rest.
        joint
            Whether start and stop are solved as one wherever that is faster.
        retime
            While a cable is hoisted: ``both`` start and stop are solved for that, or the ``stop``.
        sample_time_s
            Sample time of a program that a controller replays [s]; None for no program.

        Returns
        -------
        Maneuver
            Start, stop and the command of both, proven as a whole.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Pendulum(cable_length_m=0.8)
        >>> drive = shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
        >>> move = shapersmith.maneuver(crane, drive, "numzv", speed_m_s=0.2, distance_m=0.5)
        >>> round(move.distance_m, 9), move.residual < 1e-9
        (0.5, True)
        """
        return self._ask(
            Maneuver,
            plant=plant,
            actuator=actuator,
            shaper=_shaper(shaper),
            speed_m_s=speed_m_s,
            pulse_s=pulse_s,
            distance_m=distance_m,
            force_n=force_n,
            duration_s=duration_s,
            initial=initial,
            joint=joint,
            retime=retime,
            sample_time_s=sample_time_s,
        )

    def simulate(
        self,
        plant: Plant,
        actuator: Actuator,
        command: CommandIn | Json,
        *,
        shaper: Shaper | None = None,
        speed_m_s: float = 1.0,
        until_s: float | None = None,
        points: int = 1001,
    ) -> Simulation:
        """Play a command, shaped or not, and return the motion over time.

        Parameters
        ----------
        plant, actuator
            What moves, and what drives it.
        command
            What is played, as `StepCommand` or `ListCommand`.
        shaper
            Kind of shaper; None to play the command as it is.
        speed_m_s
            Full speed [m/s].
        until_s
            Last time; three periods after the last step if not given [s].
        points
            Number of times.

        Returns
        -------
        Simulation
            The motion at each time, and what remains of it.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Pendulum(cable_length_m=0.8)
        >>> pulse = shapersmith.PulseCommand(pulse_s=2.0)
        >>> played = shapersmith.simulate(crane, shapersmith.Ideal(), pulse, shaper="zv")
        >>> played.residual < 1e-9, played.history["angle_rad"].shape
        (True, (1001,))
        """
        return self._ask(
            Simulation,
            plant=plant,
            actuator=actuator,
            command=command,
            shaper=None if shaper is None else _shaper(shaper),
            speed_m_s=speed_m_s,
            until_s=until_s,
            points=points,
        )

    def run(
        self,
        plant: Plant,
        actuator: Actuator,
        *,
        speed_m_s: float,
        events: Sequence[Json] | None = None,
        shaping: Json | None = None,
        deflection_limit: float | None = None,
        model: CraneModel = "linear",
        played: Json | None = None,
        load: Json | None = None,
        hook_mass_kg: float | None = None,
        strokes: Json | None = None,
        max_speed_m_s: float | None = None,
        camera: Json | None = None,
        encoder: Json | None = None,
        until_s: float | None = None,
        points: int = 2001,
    ) -> Run:
        """Drive the crane by events, and return its motion.

        Parameters
        ----------
        plant, actuator
            What swings, and what drives each axis.
        speed_m_s
            Full speed [m/s].
        events
            What happens when, each as JSON has it: ``{"at_s": 0.0, "direction": {"x": 1}}``.
        shaping
            ``{"mode": "delay_line", "shaper": {...}}``; nothing shapes the commands if not given.
        deflection_limit
            In live mode: largest deflection on the way, over that of an unshaped step; any if not
            given [-].
        model
            Whether swings count as small, or as large as they are.
        played
            Courses of x and y in place of events: ``{"x": {"times_s": ..., "velocity_m_s": ...}}``.
        load
            What swings under the hook: ``{"mass_kg": ..., "length_m": ...}``.
        hook_mass_kg
            Mass of the hook; that of the mini-crane, or of a double pendulum, if not given [kg].
        strokes
            How far x and y can go: ``{"x": {"length_m": ..., "start_m": ..., "switch_m": ...}}``.
        max_speed_m_s
            Largest speed of axes and hoist; any if not given [m/s].
        camera, encoder
            Sensors, with their parameters; none if not given.
        until_s
            Last time; three periods after the last switch if not given [s].
        points
            Number of times.

        Returns
        -------
        Run
            The commands, the motion, and what remains.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Pendulum(cable_length_m=0.8)
        >>> press = {"at_s": 0.0, "direction": {"x": 1}}
        >>> done = shapersmith.run(crane, shapersmith.Ideal(), speed_m_s=0.2, events=[press])
        >>> round(done.residual, 9), done.log["deflection_m"].shape
        (1.0, (2001,))
        """
        return self._ask(
            Run,
            plant=plant,
            actuator=actuator,
            speed_m_s=speed_m_s,
            events=None if events is None else list(events),
            shaping=shaping,
            deflection_limit=deflection_limit,
            model=model,
            played=played,
            load=load,
            hook_mass_kg=hook_mass_kg,
            strokes=strokes,
            max_speed_m_s=max_speed_m_s,
            camera=camera,
            encoder=encoder,
            until_s=until_s,
            points=points,
        )

    def sensitivity(
        self,
        impulses: ImpulsesWire | Json,
        plant: Plant,
        actuator: Actuator,
        *,
        from_ratio: float = 0.5,
        to_ratio: float = 1.5,
        points: int = 201,
        tolerance: float = 0.05,
        damping: DampingRange | Json | None = None,
        drive: DriveRange | Json | None = None,
    ) -> Sensitivity:
        """Return the sensitivity curve of any impulses.

        Parameters
        ----------
        impulses
            The impulses, as `Impulses` or as ``steps`` of an answer.
        plant, actuator
            What moves, and what drives it.
        from_ratio, to_ratio, points
            First and last frequency ratio [-], and how many.
        tolerance
            Residual of the insensitivity [-].
        damping
            Range of a curve over the damping ratio; None for none.
        drive
            By how much the drive may be off; None for no such curve.

        Returns
        -------
        Sensitivity
            The curve, its insensitivity, and the residual at the nominal.

        Examples
        --------
        >>> import shapersmith
        >>> mode = shapersmith.Mode(natural_frequency_rad_s=3.5)
        >>> halves = shapersmith.Impulses(times_s=[0, 0.8976], amplitudes=[0.5, 0.5])
        >>> curve = shapersmith.sensitivity(halves, mode, shapersmith.Ideal())
        >>> round(curve.sensitivity.insensitivity.width, 4)
        0.0637
        """
        return self._ask(
            Sensitivity,
            impulses=impulses,
            plant=plant,
            actuator=actuator,
            from_ratio=from_ratio,
            to_ratio=to_ratio,
            points=points,
            tolerance=tolerance,
            damping=damping,
            drive=drive,
        )

    def fit(self, plant: Plant, actuator: Actuator, shaper: Shaper, fit: FitRange | Json) -> Fit:
        """Return curve coefficients of a shaper over one field of the plant.

        Parameters
        ----------
        plant, actuator, shaper
            What moves, what drives it, and the kind of shaper.
        fit
            The field, its range, and the degree or the largest residual.

        Returns
        -------
        Fit
            The coefficients, with the residual of the fitted times.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Pendulum(cable_length_m=0.8)
        >>> drive = shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
        >>> length = "/plant/cable_length_m"
        >>> lengths = shapersmith.FitRange(over=length, from_=0.6, to=1.0, degree=3)
        >>> shapersmith.fit(crane, drive, "numzv", lengths).worst_residual < 1e-3
        True
        """
        return self._ask(Fit, plant=plant, actuator=actuator, shaper=_shaper(shaper), fit=fit)

    def field_map(
        self,
        plant: Plant,
        actuator: Actuator,
        x: Axis | Json,
        y: Axis | Json | None = None,
        *,
        shaper: Shaper | None = None,
        impulses: ImpulsesWire | Json | None = None,
        move: Move | Json | None = None,
        quantity: Quantity = "residual",
        speed_m_s: float | None = None,
        design: Literal["once", "each"] = "once",
        designed_for: Model | None = None,
    ) -> FieldMap:
        """Return a quantity of a shaper or a whole move over one or two fields.

        Parameters
        ----------
        plant, actuator
            What moves, and what drives it.
        x, y
            The fields; without y it is a curve.
        shaper, impulses
            Kind of shaper, or impulses that are held in every cell.
        move
            The move that the shaper starts and stops; None for its start alone.
        quantity
            What is mapped.
        speed_m_s
            Full speed, for ``deflection_m`` [m/s].
        design
            Whether the shaper is designed ``once``, or anew in ``each`` cell.
        designed_for
            Model of the actuator that it is designed for; None for that of the actuator.

        Returns
        -------
        FieldMap
            The quantity in every cell.

        Examples
        --------
        >>> import shapersmith
        >>> crane = shapersmith.Pendulum(cable_length_m=0.8)
        >>> lengths = shapersmith.Axis(field="/plant/cable_length_m", values=[0.6, 0.8, 1.0])
        >>> curve = shapersmith.field_map(crane, shapersmith.Ideal(), lengths, shaper="zv")
        >>> curve.values.round(3)
        array([0.241, 0.   , 0.165])
        """
        return self._ask(
            FieldMap,
            plant=plant,
            actuator=actuator,
            x=x,
            y=y,
            shaper=None if shaper is None else _shaper(shaper),
            impulses=impulses,
            move=move,
            quantity=quantity,
            speed_m_s=speed_m_s,
            design=design,
            designed_for=designed_for,
        )

    def _ask(self, answer: type[Answered], **request: Any) -> Answered:  # noqa: ANN401
        return self.ask(answer, as_json(request))


def _shaper(shaper: Shaper) -> ShaperRequest | Mapping[str, Any]:
    return {"kind": shaper} if isinstance(shaper, str) else shaper
