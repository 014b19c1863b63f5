"""Live shaping in C: its state, and how swing and drive go on."""

from string import Template

WAVES = """\
#ifndef SHAPERSMITH_WAVES_DEFINED
#define SHAPERSMITH_WAVES_DEFINED
#ifdef SHAPERSMITH_FLOAT
#define SHAPERSMITH_EXP(value) expf(value)
#define SHAPERSMITH_SIN(value) sinf(value)
#define SHAPERSMITH_COS(value) cosf(value)
#define SHAPERSMITH_ATAN(value) atanf(value)
#define SHAPERSMITH_ABS(value) fabsf(value)
#else
#define SHAPERSMITH_EXP(value) exp(value)
#define SHAPERSMITH_SIN(value) sin(value)
#define SHAPERSMITH_COS(value) cos(value)
#define SHAPERSMITH_ATAN(value) atan(value)
#define SHAPERSMITH_ABS(value) fabs(value)
#endif
#endif
"""
"""Functions of that type of numbers, defined once in a program."""


BOUNDS = Template("""\
#ifdef SHAPERSMITH_FLOAT
#define ${UPPER}_BOUND $SINGLE
#else
#define ${UPPER}_BOUND $DOUBLE
#endif
""")


STATE = Template("""\
#define ${UPPER}_ENTRIES 8
#define ${UPPER}_ITERATIONS $ITERATIONS
#define ${UPPER}_CORRECTIONS $CORRECTIONS
#define ${UPPER}_WAITS $WAITS
#define ${UPPER}_TRIES $TRIES
#define ${UPPER}_HEIGHTS $HEIGHTS

/* What swings and how the drive follows: the swing with what the drive will still leave added, then
   error and rate of the velocity. */
typedef struct {
    shapersmith_real re;
    shapersmith_real im;
    shapersmith_real error;
    shapersmith_real rate;
} ${NAME}_motion;

/* How a motion goes on over a time without a switch. */
typedef struct {
    shapersmith_real x;
    shapersmith_real y;
    shapersmith_real ee;
    shapersmith_real er;
    shapersmith_real re;
    shapersmith_real rr;
} ${NAME}_flow;

/* Levels that are still to be sent: each from a call on, counted from the one that planned. */
typedef struct {
    long at[${UPPER}_ENTRIES];
    shapersmith_real level[${UPPER}_ENTRIES];
    int count;
} ${NAME}_plan;

/* The block; zeros at first. What it answers stands above. */
typedef struct {
    shapersmith_real share;
    shapersmith_real velocity_m_s;
    int busy;
    int kept;
    int valid;
    int held;
    int error;
    shapersmith_real residual;
    int enabled;
    int set;
    shapersmith_real target;
    shapersmith_real top;
    shapersmith_real elapsed_s;
    shapersmith_real lost_s;
    shapersmith_real length_m;
    shapersmith_real decay;
    shapersmith_real turn;
    shapersmith_real of_set[2][4];
    shapersmith_real limit;
    ${NAME}_motion motion;
    ${NAME}_plan plan;
    int next;
    long calls;
} ${NAME}_shaper;

/* The set in force after a change of the level: 0 for more speed, 1 for less. */
static inline int ${NAME}_set_of(shapersmith_real before, shapersmith_real after, int now)
{
    const shapersmith_real more = SHAPERSMITH_ABS(after) - SHAPERSMITH_ABS(before);
    return more > SHAPERSMITH_C(0.0) ? 0 : more < SHAPERSMITH_C(0.0) ? 1 : now;
}

/* The angle of a vector, from -pi to pi. */
static inline shapersmith_real ${NAME}_angle(shapersmith_real x, shapersmith_real y)
{
    const shapersmith_real quarter = $QUARTER;
    if (SHAPERSMITH_ABS(x) > SHAPERSMITH_ABS(y)) {
        const shapersmith_real angle = SHAPERSMITH_ATAN(y / x);
        return x > SHAPERSMITH_C(0.0) ? angle
               : y > SHAPERSMITH_C(0.0) ? angle + quarter * SHAPERSMITH_C(2.0)
                                        : angle - quarter * SHAPERSMITH_C(2.0);
    }
    if (y > SHAPERSMITH_C(0.0)) {
        return quarter - SHAPERSMITH_ATAN(x / y);
    }
    return y < SHAPERSMITH_C(0.0) ? -quarter - SHAPERSMITH_ATAN(x / y) : SHAPERSMITH_C(0.0);
}

""")


FLOW = Template("""\
/* How the motion goes on for a time behind a set. */
static inline ${NAME}_flow ${NAME}_over(
    const ${NAME}_shaper *shaper, shapersmith_real time_s, int set)
{
    ${NAME}_flow flow;
    const shapersmith_real decay = SHAPERSMITH_EXP(shaper->decay * time_s);
    flow.x = decay * SHAPERSMITH_COS(shaper->turn * time_s);
    flow.y = decay * SHAPERSMITH_SIN(shaper->turn * time_s);
$LAG    return flow;
}

static inline void ${NAME}_go(${NAME}_motion *motion, const ${NAME}_flow *flow)
{
    const shapersmith_real re = motion->re;
    const shapersmith_real error = motion->error;
    motion->re = flow->x * re - flow->y * motion->im;
    motion->im = flow->x * motion->im + flow->y * re;
    motion->error = flow->ee * error + flow->er * motion->rate;
    motion->rate = flow->re * error + flow->rr * motion->rate;
}

/* Switch the level by a change, from one set into another. */
static inline void ${NAME}_switch(
    const ${NAME}_shaper *shaper, ${NAME}_motion *motion, shapersmith_real change, int old, int set)
{
    const shapersmith_real *of = shaper->of_set[old];
    const shapersmith_real *to = shaper->of_set[set];
$SWITCH}

/* How fast a motion changes behind a set. */
static inline ${NAME}_motion ${NAME}_slope(
    const ${NAME}_shaper *shaper, const ${NAME}_motion *motion, int set)
{
    ${NAME}_motion slope;
    slope.re = shaper->decay * motion->re - shaper->turn * motion->im;
    slope.im = shaper->decay * motion->im + shaper->turn * motion->re;
$SLOPE    return slope;
}

/* Swing, frequency and gains of a cable length. */
static inline void ${NAME}_length(${NAME}_shaper *shaper, shapersmith_real length_m)
{
    const shapersmith_real frequency = $FREQUENCY;
    int set;
    shaper->length_m = length_m;
    shaper->decay = -frequency * $DAMPING;
    shaper->turn = frequency * $ROOT;
    for (set = 0; set < 2; ++set) {
        /* 1 / G = 1 + s (first + second s), at the pole s of the swing. */
        const shapersmith_real p = shaper->decay;
        const shapersmith_real q = shaper->turn;
        const shapersmith_real first = ${NAME}_first_s[set];
        const shapersmith_real second = ${NAME}_second_s2[set];
        const shapersmith_real re = SHAPERSMITH_C(1.0) + first * p + second * (p * p - q * q);
        const shapersmith_real im = q * (first + SHAPERSMITH_C(2.0) * second * p);
        const shapersmith_real size = re * re + im * im;
        shaper->of_set[set][0] = -re / size;
        shaper->of_set[set][1] = im / size;
        shaper->of_set[set][2] = second * (re * p + im * q) / size;
        shaper->of_set[set][3] = second * (re * q - im * p) / size;
        if (set == 0) {
            shaper->limit = $BOUND / SHAPERSMITH_SQRT(size);
        }
    }
}

""")


ONE_LAG = {
    "LAG": """\
    flow.ee = SHAPERSMITH_C(0.0);
    flow.er = SHAPERSMITH_C(0.0);
    flow.re = SHAPERSMITH_C(0.0);
    flow.rr = SHAPERSMITH_C(0.0);
    (void)set;
""",
    "SWITCH": """\
    motion->re -= to[0] * change;
    motion->im -= to[1] * change;
    (void)of;
""",
    "SLOPE": """\
    slope.error = SHAPERSMITH_C(0.0);
    slope.rate = SHAPERSMITH_C(0.0);
    (void)set;
""",
}
"""Of drives whose steps add up: only the swing has a state."""


SWITCH = """\
    motion->re -= of[0] * motion->error + of[2] * motion->rate;
    motion->im -= of[1] * motion->error + of[3] * motion->rate;
    motion->error -= change;
    motion->re += to[0] * motion->error + to[2] * motion->rate;
    motion->im += to[1] * motion->error + to[3] * motion->rate;
"""


FIRST_ORDER = {
    "LAG": """\
    flow.ee = SHAPERSMITH_EXP(-time_s / ${NAME}_first_s[set]);
    flow.er = SHAPERSMITH_C(0.0);
    flow.re = SHAPERSMITH_C(0.0);
    flow.rr = SHAPERSMITH_C(0.0);
""",
    "SWITCH": SWITCH,
    "SLOPE": """\
    slope.error = -motion->error / ${NAME}_first_s[set];
    slope.rate = SHAPERSMITH_C(0.0);
""",
}
"""Of a switched drive of first order."""


SECOND_ORDER = {
    "LAG": """\
    {
        const shapersmith_real corner = ${NAME}_corner_rad_s[set];
        const shapersmith_real damping = ${NAME}_damping[set];
        const shapersmith_real root = ${NAME}_root[set];
        const shapersmith_real phase = corner * time_s;
        const shapersmith_real turn = root * phase;
        shapersmith_real even, odd;
        if (damping < SHAPERSMITH_C(1.0)) {
            const shapersmith_real fade = SHAPERSMITH_EXP(-damping * phase);
            even = fade * SHAPERSMITH_COS(turn);
            odd = fade * phase;
            if (SHAPERSMITH_ABS(turn) > SHAPERSMITH_C(0.0)) {
                odd = odd * (SHAPERSMITH_SIN(turn) / turn);
            }
        } else {
            const shapersmith_real slow = SHAPERSMITH_EXP(-phase / (damping + root));
            const shapersmith_real fast = SHAPERSMITH_EXP(SHAPERSMITH_C(-2.0) * turn);
            even = slow * (SHAPERSMITH_C(1.0) + fast) / SHAPERSMITH_C(2.0);
            if (SHAPERSMITH_ABS(turn) < $SHORTTURN) {
                shapersmith_real term = SHAPERSMITH_C(1.0);
                shapersmith_real mean = SHAPERSMITH_C(1.0);
                int power;
                for (power = 1; power < $SERIES; ++power) {
                    term = term * (SHAPERSMITH_C(-2.0) * turn / (shapersmith_real)(power + 1));
                    mean += term;
                }
                odd = slow * phase * mean;
            } else {
                odd = slow * (SHAPERSMITH_C(1.0) - fast) / (SHAPERSMITH_C(2.0) * root);
            }
        }
        flow.ee = even + damping * odd;
        flow.er = odd / corner;
        flow.re = -odd * corner;
        flow.rr = even - damping * odd;
    }
""",
    "SWITCH": SWITCH,
    "SLOPE": """\
    slope.error = motion->rate;
    slope.rate = -(motion->error + ${NAME}_first_s[set] * motion->rate) / ${NAME}_second_s2[set];
""",
}
"""Of a switched drive of second order."""


LAGS = {0: ONE_LAG, 1: FIRST_ORDER, 2: SECOND_ORDER}
