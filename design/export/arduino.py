"""An Arduino library: the C header in the folder that its editor imports, with an example.

The editor takes an archive by "Add .ZIP Library"; the folder in it has ``library.properties``,
``src`` and ``examples`` [1]_. Boards whose double is as wide as float lose nothing by float.

References
----------
.. [1] Arduino, "Library specification", arduino.github.io/arduino-cli/latest/library-specification.
"""

import io
import math
import re
import zipfile
from collections.abc import Iterable, Iterator
from string import Template

import numpy as np

from design.errors import InvalidInputError
from design.export.c_header import write_c
from design.export.header import TOOL
from design.export.kind import Export
from design.export.program import check_program, listing, name_of
from design.export.twincat import UNDATED
from design.tables.columns import times_of
from design.tables.rows import Rows, TableHead

VERSION = re.compile(r"\d+\.\d+\.\d+")
"""What the specification takes; a version of the tool may have more behind it."""

PROPERTIES = Template("""\
name=$NAME
version=$VERSION
author=$TOOL
maintainer=$TOOL
sentence=Input shaper: $TITLE
paragraph=Times and amplitudes of impulses, and a delay line that shapes a command.
category=Signal Input/Output
url=
architectures=*
""")

EXAMPLE = Template("""\
// Shapes a command that an analog input gives, every $MILLISECONDS ms.
#include <$NAME.h>

static shapersmith_real memory[$CELLS];
static ${NAME}_shaper shaper;
static unsigned long next_ms;

void setup()
{
    ${NAME}_start(&shaper, memory, $CELLS, SHAPERSMITH_C(0.0));
    $SET
    next_ms = millis();
}

void loop()
{
    if ((long)(millis() - next_ms) < 0) {
        return;
    }
    next_ms += $MILLISECONDS;
    const shapersmith_real command = (shapersmith_real)analogRead(A0) / SHAPERSMITH_C(1023.0);
    const shapersmith_real shaped = ${NAME}_step(&shaper, command);
    analogWrite(9, (int)(SHAPERSMITH_C(255.0) * shaped));
}
""")

CELLS = 200
"""Of the delay line of the example: 800 bytes in float, which the smallest boards have."""


def check_arduino(head: TableHead) -> None:
    """Raise InvalidInputError where a library cannot take the table."""
    check_program(head)
    if head.on_samples:
        raise InvalidInputError(
            "shaper.sample_time_s",
            "given",
            "left out for an Arduino library, whose example counts milliseconds; take c",
            code="arduino_not_on_samples",
        )


def write_arduino(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as an archive of an Arduino library.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        The archive, whole.

    Raises
    ------
    InvalidInputError
        If a number of the table is infinite.
    """
    name, held = name_of(head), list(runs)
    longest_s = max(float(np.nanmax(times_of(head, rows), initial=0.0)) for rows in held)
    milliseconds = max(1, math.ceil(1000 * longest_s / (CELLS - 2)))
    of_row = "" if listing(head, held).shared_amplitudes is not None else "[0]"
    version = VERSION.match(head.version)
    properties = PROPERTIES.substitute(
        NAME=name,
        VERSION="0.0.0" if version is None else version[0],
        TOOL=TOOL,
        TITLE=" ".join(head.title.split()),
    )
    example = EXAMPLE.substitute(
        NAME=name,
        CELLS=CELLS,
        MILLISECONDS=milliseconds,
        SET=f"{name}_set(&shaper, {name}_times[0], {name}_amplitudes{of_row}, "
        f"SHAPERSMITH_C({milliseconds}e-3));",
    )
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for path, data in (
            ("library.properties", properties.encode()),
            (f"src/{name}.h", b"".join(write_c(head, held))),
            (f"examples/{name}/{name}.ino", example.encode()),
        ):
            archive.writestr(zipfile.ZipInfo(f"{name}/{path}", date_time=UNDATED), data)
    yield file.getvalue()


EXPORT = Export(
    name="arduino",
    media_type="application/zip",
    suffix=".zip",
    checks=check_arduino,
    write=write_arduino,
)
