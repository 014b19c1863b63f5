"""CasADi functions called through buffers: no conversion of arguments, a tenth of a millisecond."""

from collections.abc import Callable
from typing import Any

import numpy as np

from design.types import FloatArray, Symbolic


class Buffered:
    """A CasADi function with its own arrays for inputs and outputs.

    Parameters
    ----------
    function
        The function; dense inputs and outputs.
    inputs, outputs
        Names of those that are used; inputs not named are zero.

    Attributes
    ----------
    inputs, outputs
        An array for each, flat and column-major; write, `run`, read.
    stats
        Returns the statistics of the last run of a solver.
    """

    def __init__(
        self,
        function: Symbolic,
        inputs: tuple[str, ...],
        outputs: tuple[str, ...],
    ) -> None:
        self._function = function  # kept alive: the buffer only points to it
        self._buffer, self.run = function.buffer()
        self.stats: Callable[[], dict[str, Any]] = self._buffer.stats
        self.inputs: dict[str, FloatArray] = {}
        self.outputs: dict[str, FloatArray] = {}
        for name in inputs:
            self.inputs[name] = np.zeros(function.numel_in(name))
            self._buffer.set_arg(function.index_in(name), self.inputs[name].data)
        for name in outputs:
            self.outputs[name] = np.zeros(function.numel_out(name))
            self._buffer.set_res(function.index_out(name), self.outputs[name].data)
