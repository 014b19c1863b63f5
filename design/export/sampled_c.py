"""The parts of a C99 header that a table on samples has in place of others."""

from string import Template

from design.export.program import decimal
from design.export.sampled_program import SAME_SAMPLE_TIME, SampledListing

ROWS = Template("""\
/* Number of the sample of each impulse, from the first on. A row of fewer impulses repeats its last
   with amplitude 0. */
static const size_t ${NAME}_samples[${UPPER}_ROWS][${UPPER}_IMPULSES] = {
$SAMPLES
};

/* Sample time of each row [s]; 0 where there is no design. */
static const shapersmith_real ${NAME}_sample_times[${UPPER}_ROWS] = {
$SAMPLETIMES
};

""")

SHAPER = Template("""\
/* A shaper for a live command, on the samples of a controller: each impulse delays the command by a
   whole number of samples and adds it by its amplitude. The caller owns the memory of the delay
   line, of ${UPPER}_LINE cells or more: no allocation.

     static shapersmith_real memory[${UPPER}_LINE];
     static ${NAME}_shaper shaper;
     ${NAME}_start(&shaper, memory, ${UPPER}_LINE, SHAPERSMITH_C(0.0));
     ${NAME}_set(&shaper, row, sample_time_s);
     every sample: out = ${NAME}_step(&shaper, in); */
#define ${UPPER}_LINE $CELLS

typedef struct {
    shapersmith_real *line;
    size_t length;
    size_t newest;
    size_t whole[${UPPER}_IMPULSES];
    shapersmith_real amplitude[${UPPER}_IMPULSES];
} ${NAME}_shaper;

/* Begin at rest at a command; until ${NAME}_set the command passes as it is. */
static inline void ${NAME}_start(${NAME}_shaper *shaper, shapersmith_real *memory, size_t length,
                              shapersmith_real command)
{
    size_t k;
    for (k = 0; k < length; ++k) {
        memory[k] = command;
    }
    shaper->line = memory;
    shaper->length = length;
    shaper->newest = 0;
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        shaper->whole[k] = 0;
        shaper->amplitude[k] = SHAPERSMITH_C(0.0);
    }
    shaper->amplitude[0] = SHAPERSMITH_C(1.0);
}

/* Take another row, the delay line stays. Returns 0; or -1, and changes nothing, if there is no
   such row, it has no design, the sample time of the controller is not that of the row, or the line
   is shorter than the row needs. */
static inline int ${NAME}_set(${NAME}_shaper *shaper, size_t row, shapersmith_real sample_time_s)
{
    size_t k;
    shapersmith_real apart;
    if (row >= ${UPPER}_ROWS || ${NAME}_status[row] == 1 || ${NAME}_status[row] == 2) {
        return -1;
    }
    apart = sample_time_s / ${NAME}_sample_times[row] - SHAPERSMITH_C(1.0);
    /* Written so that not-a-number fails. */
    if (!(apart <= SHAPERSMITH_C($SAME) && apart >= SHAPERSMITH_C(-$SAME)
          && ${NAME}_samples[row][${UPPER}_IMPULSES - 1] < shaper->length)) {
        return -1;
    }
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        shaper->whole[k] = ${NAME}_samples[row][k];
        shaper->amplitude[k] = ${NAME}_amplitudes[row][k];
    }
    return 0;
}

/* Take one sample of the command, return one of the shaped command. */
static inline shapersmith_real ${NAME}_step(${NAME}_shaper *shaper, shapersmith_real command)
{
    shapersmith_real shaped = SHAPERSMITH_C(0.0);
    size_t k;
    shaper->newest = shaper->newest + 1 < shaper->length ? shaper->newest + 1 : 0;
    shaper->line[shaper->newest] = command;
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        const size_t back = shaper->whole[k];
        const size_t at = shaper->newest >= back ? shaper->newest - back
                                                 : shaper->newest + shaper->length - back;
        shaped += shaper->amplitude[k] * shaper->line[at];
    }
    return shaped;
}
""")


def sampled_rows_in_c(name: str, rows: SampledListing) -> str:
    """Return the whole numbers of the rows as C.

    Parameters
    ----------
    name
        Start of the names.
    rows
        The rows.

    Returns
    -------
    str
        Arrays of samples and sample times.
    """
    samples = ["    {" + ", ".join(map(str, row)) + "}" for row in rows.samples.tolist()]
    times = [f"    SHAPERSMITH_C({decimal(value)})" for value in rows.sample_times_s.tolist()]
    return ROWS.substitute(
        NAME=name,
        UPPER=name.upper(),
        SAMPLES=",\n".join(samples),
        SAMPLETIMES=",\n".join(times),
    )


def sampled_shaper_in_c(name: str, rows: SampledListing) -> str:
    """Return the shaper as C.

    Parameters
    ----------
    name
        Start of the names.
    rows
        The rows.

    Returns
    -------
    str
        Its type and functions.
    """
    return SHAPER.substitute(
        NAME=name, UPPER=name.upper(), CELLS=rows.cells, SAME=decimal(SAME_SAMPLE_TIME)
    )
