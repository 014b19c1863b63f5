"""What sensors report of a motion that was seen."""

from dataclasses import dataclass

import numpy as np

from design.rig.camera import Camera
from design.rig.encoder import Encoder
from design.rig.track import Track
from design.types import FloatArray, IntArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensed:
    """Reports at n times; None without the sensor.

    Attributes
    ----------
    pulses_x, pulses_y
        Of the encoders, shape (n,).
    pixels_x, pixels_y, width_pixels
        Centre and width of the marker, shape (n,) [pixels].
    """

    pulses_x: IntArray | None
    pulses_y: IntArray | None
    pixels_x: FloatArray | None
    pixels_y: FloatArray | None
    width_pixels: FloatArray | None


def sensed(track: Track, encoder: Encoder | None, camera: Camera | None, seed: int) -> Sensed:
    """Return what sensors report of a motion.

    Parameters
    ----------
    track
        The motion, at n times.
    encoder
        On x and y; none if None.
    camera
        At the trolley, with an image at each time; none if None.
    seed
        Of its noise.

    Returns
    -------
    Sensed
        The reports.

    Raises
    ------
    InvalidInputError
        If the hook is not below the camera.
    """
    counts: list[IntArray | None] = [None, None]
    if encoder is not None:
        counts = [encoder.pulses(track.position_m[:, axis]) for axis in (0, 1)]
    seen: list[FloatArray | None] = [None, None, None]
    if camera is not None:
        noise = np.random.default_rng(seed)
        frames = [camera.frame(hook, noise) for hook in track.hook_m]
        seen = list(np.array([[*frame.pixels, frame.width_pixels] for frame in frames]).T)
    return Sensed(
        pulses_x=counts[0],
        pulses_y=counts[1],
        pixels_x=seen[0],
        pixels_y=seen[1],
        width_pixels=seen[2],
    )
