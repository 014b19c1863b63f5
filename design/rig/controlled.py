"""The machine under a controller that sees it through its sensors, sample by sample."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from design.checks import require_scale
from design.errors import InvalidInputError
from design.rig.camera import Camera, Frame
from design.rig.crane import AXES
from design.rig.encoder import Encoder
from design.rig.machine import Machine
from design.rig.march import MOTION, ROPE, ROW_SIZE
from design.rig.swing import UPPER
from design.rig.track import Track
from design.types import FloatArray, IntArray

MAX_SAMPLES = 10_000_000
"""Most samples of a run: some gigabytes of what is seen."""


class Reading(NamedTuple):
    """What a controller reads at a sample.

    Attributes
    ----------
    at_s
        The time [s].
    position_m
        Of the trolley in x and y, as the encoders say [m].
    cable_length_m
        Of the upper cable, as the hoist's encoder says [m].
    frame
        What the camera found last; None without one.
    pressed
        Side of the limit switch that is pressed in x and y: -1, 0 or 1.
    """

    at_s: float
    position_m: tuple[float, float]
    cable_length_m: float
    frame: Frame | None
    pressed: tuple[int, int]


Controller = Callable[[Reading], tuple[float, float]]
"""From a reading to the levels of x and y until the next sample, shares of full speed [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ControlledRun:
    """A run under a controller, of n samples.

    Attributes
    ----------
    track
        The motion at the samples.
    levels
        What the controller commanded at each, shape (n, 2) [-].
    pulses
        What the encoders of x and y counted, shape (n, 2).
    pixels
        Centre of the marker in the latest image, shape (n, 2); None without a camera [pixels].
    """

    track: Track
    levels: FloatArray
    pulses: IntArray
    pixels: FloatArray | None


def run_controlled(
    machine: Machine,
    controller: Controller,
    sample_time_s: float,
    until_s: float,
    encoder: Encoder | None = None,
    camera: Camera | None = None,
    seed: int = 0,
) -> ControlledRun:
    """Let a controller drive the machine from now on.

    Parameters
    ----------
    machine
        The machine; it goes on from where it is.
    controller
        Called at every sample; what it commands holds until the next.
    sample_time_s
        Time between samples, > 0 [s].
    until_s
        The last sample is at or before it [s].
    encoder
        On every axis and the hoist; the thesis's if not given.
    camera
        What looks at the hook; none if not given.
    seed
        Of the camera's noise.

    Returns
    -------
    ControlledRun
        What happened, at each sample, before the command that is given there.

    Raises
    ------
    InvalidInputError
        If there are more than ten million samples, a level is more than full speed, or the run
        ends as `Machine.advance` says.
    """
    require_scale("sample_time_s", sample_time_s)
    start_s = machine.now_s
    count = 1 + int(np.floor((until_s - start_s) / sample_time_s * (1 + 1e-12)))
    if not 1 <= count <= MAX_SAMPLES:
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            f"such that there are 1 to {MAX_SAMPLES:,} samples",
            code="samples_out_of_range",
        )
    encoder = encoder or Encoder()
    noise = np.random.default_rng(seed)
    frames_s = None if camera is None else camera.frame_time_s
    frame, next_frame_s = None, start_s
    times = start_s + sample_time_s * np.arange(count)
    rows, levels = np.empty((count, ROW_SIZE)), np.zeros((count, 2))
    pixels = None if camera is None else np.zeros((count, 2))
    held: tuple[float, float] | None = None
    for index, now in enumerate(times.tolist()):
        here = slice(index, index + 1)
        machine.advance_into(rows[here], now, times[here])
        row = rows[index]
        if camera is not None and frames_s is not None and now >= next_frame_s:
            frame = camera.frame(row[ROPE] * row[UPPER : UPPER + 3], noise)
            next_frame_s += frames_s
        told = controller(
            Reading(
                at_s=now,
                position_m=(
                    encoder.position_m(float(row[MOTION])),
                    encoder.position_m(float(row[MOTION + 4])),
                ),
                cable_length_m=encoder.position_m(float(row[ROPE])),
                frame=frame,
                pressed=machine.pressed,
            )
        )
        for axis, name in enumerate(AXES):
            if held is None or told[axis] != held[axis]:
                machine.command(name, told[axis])
        held = told
        levels[index] = told
        if pixels is not None and frame is not None:
            pixels[index, 0], pixels[index, 1] = frame.pixels
    track = Track(crane=machine.crane, times_s=times, rows=rows)
    return ControlledRun(
        track=track,
        levels=levels,
        pulses=np.stack([encoder.pulses(column) for column in track.position_m.T], axis=1),
        pixels=pixels,
    )
