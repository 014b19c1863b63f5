"""Live shaping in C: which plans are tried, and what is done once a cycle."""

from string import Template

WAIT = Template("""\
/* Cycles of a wait by its number. */
static inline long ${NAME}_wait(int number, shapersmith_real cycles)
{
    const long wait = (long)((shapersmith_real)number * $EACH * cycles);
    return number > 0 && wait < 1 ? 1 : wait;
}

""")


REPLAN = Template("""\
/* Plan anew from a motion. Returns whether a plan is within the bound. */
static inline int ${NAME}_replan(
    ${NAME}_shaper *shaper, const ${NAME}_motion *now, shapersmith_real wanted,
    shapersmith_real cycle_s)
{
    const shapersmith_real level = shaper->share;
    const shapersmith_real quarter = $QUARTER;
    const shapersmith_real cycles = SHAPERSMITH_C(1.0) / (shaper->turn * cycle_s);
    const int turning = level * wanted < SHAPERSMITH_C(0.0);
    const shapersmith_real hold = turning ? SHAPERSMITH_C(0.0) : level;
    const int hold_set = ${NAME}_set_of(level, hold, shaper->set);
    const int waits = level != wanted ? ${UPPER}_WAITS : 1;
    ${NAME}_motion of_wait[${UPPER}_WAITS];
    shapersmith_real ends[${UPPER}_WAITS * 4], froms[${UPPER}_WAITS * 4];
    shapersmith_real best = $NEVER;
    ${NAME}_plan plan;
    int k, j, tries;
    for (k = 0; k < waits * 4; ++k) {
        ends[k] = $NEVER;
    }
    for (k = turning ? 1 : 0; k < waits; ++k) {
        const long wait = ${NAME}_wait(k, cycles);
        const int set = ${NAME}_set_of(hold, wanted, hold_set);
        ${NAME}_motion motion = *now;
        shapersmith_real size;
        if (hold != level) {
            ${NAME}_switch(shaper, &motion, hold - level, shaper->set, hold_set);
        }
        if (wait > 0) {
            const ${NAME}_flow flow = ${NAME}_over(
                shaper, (shapersmith_real)wait * cycle_s, hold_set);
            ${NAME}_go(&motion, &flow);
        }
        of_wait[k] = motion;
        if (wanted != hold) {
            ${NAME}_switch(shaper, &motion, wanted - hold, hold_set, set);
        }
        size = ${NAME}_size(&motion);
        if (size <= shaper->limit && (shapersmith_real)wait < best) {
            /* Nothing is left to cancel. */
            best = (shapersmith_real)wait;
            shaper->plan.count = 0;
            ${NAME}_add(&shaper->plan, 0, hold);
            ${NAME}_add(&shaper->plan, wait, wanted);
            shaper->residual = size;
        }
        for (j = 0; j < 2; ++j) {
            const shapersmith_real other = j == 0 ? SHAPERSMITH_C(0.0) : shaper->top;
            const int set_other = ${NAME}_set_of(wanted, other, set);
            const shapersmith_real *up = shaper->of_set[set_other];
            const shapersmith_real *down =
                shaper->of_set[${NAME}_set_of(other, wanted, set_other)];
            const shapersmith_real height = other - wanted;
            shapersmith_real share, half, begin, end;
            if (!(SHAPERSMITH_ABS(height) > SHAPERSMITH_C(0.0))
                || (j == 1 && !(other * other > SHAPERSMITH_C(0.0)))
                || other * wanted < SHAPERSMITH_C(0.0)) {
                continue;
            }
            /* The pulse of an ideal drive: half its turn is the angle whose sine is share. */
            share = size / (SHAPERSMITH_ABS(height)
                            * (SHAPERSMITH_SQRT(up[0] * up[0] + up[1] * up[1])
                               + SHAPERSMITH_SQRT(down[0] * down[0] + down[1] * down[1])));
            if (share > $REACH) {
                continue;
            }
            half = share < SHAPERSMITH_C(1.0)
                       ? ${NAME}_angle(
                           SHAPERSMITH_SQRT(SHAPERSMITH_C(1.0) - share * share), share)
                       : quarter;
            begin = ${NAME}_angle(-up[0], -up[1]) + quarter - half
                    - ${NAME}_angle(-motion.re * height, -motion.im * height);
            end = half * SHAPERSMITH_C(2.0) + ${NAME}_angle(-down[0], -down[1])
                  - ${NAME}_angle(-up[0], -up[1]);
            if (end < $SHORTEST) {
                end = $SHORTEST;
            }
            while (begin >= SHAPERSMITH_C(4.0) * quarter - $EARLY) {
                begin -= SHAPERSMITH_C(4.0) * quarter;
            }
            while (begin < -$EARLY) {
                begin += SHAPERSMITH_C(4.0) * quarter;
            }
            froms[4 * k + 2 * j] = begin * cycles;
            ends[4 * k + 2 * j] = (begin + end) * cycles;
            if (begin < $EARLY) {
                froms[4 * k + 2 * j + 1] = (begin + SHAPERSMITH_C(4.0) * quarter) * cycles;
                ends[4 * k + 2 * j + 1] = ends[4 * k + 2 * j]
                                          + SHAPERSMITH_C(4.0) * quarter * cycles;
            }
        }
    }
    for (tries = 0; tries < ${UPPER}_TRIES; ++tries) {
        int first = -1;
        shapersmith_real least = best;
        shapersmith_real residual, other;
        long wait;
        for (k = turning ? 4 : 0; k < waits * 4; ++k) {
            if ((shapersmith_real)${NAME}_wait(k / 4, cycles) + ends[k] < least) {
                least = (shapersmith_real)${NAME}_wait(k / 4, cycles) + ends[k];
                first = k;
            }
        }
        if (first < 0) {
            break;
        }
        wait = ${NAME}_wait(first / 4, cycles);
        other = first % 4 < 2 ? SHAPERSMITH_C(0.0) : shaper->top;
        /* Sets change with whole calls, so that a height may have no solution: then a lower one. */
        for (j = 0; j < ${UPPER}_HEIGHTS; ++j) {
            plan.count = 0;
            if (wait > 0) {
                ${NAME}_add(&plan, 0, hold);
            }
            if (${NAME}_solve(shaper, of_wait[first / 4], hold_set, hold, wanted, other, cycle_s,
                              wait, froms[first], ends[first], &plan, &residual)) {
                if ((shapersmith_real)plan.at[plan.count - 1] < best) {
                    best = (shapersmith_real)plan.at[plan.count - 1];
                    shaper->plan = plan;
                    shaper->residual = residual;
                }
                break;
            }
            other = wanted + (other - wanted) * $LOWER;
        }
        ends[first] = $NEVER;
    }
    return best < $NEVER;
}

""")


STEP = Template("""\
/* Call it once a cycle. Of what it answers:
   share         the speed over the full speed, to the drive; velocity_m_s the speed
   busy          1 while switches are still to come
   kept          1 while wanted waits: no plan was found within the bound, the last one goes on
   valid         1 while cable_length_m is one of this crane
   held          1 while another length than cable_length_m is in use
   error         1 from a cycle_time_s that is not above 0 or above $LONGEST s, until enable is 0
   residual      of the last plan, as the block counted it
   enable 0 is speed 0 at once: take it away at rest only. wanted is a share, -1 to 1. */
static inline void ${NAME}_step(
    ${NAME}_shaper *shaper, int enable, shapersmith_real wanted,$LENGTHINPUT
    shapersmith_real cycle_time_s)
{
    if (!enable || !shaper->enabled) {
        const ${NAME}_shaper rest = {0};
        *shaper = rest;
        shaper->elapsed_s = $SETTLED;
        if (!enable) {
            return;
        }
        shaper->enabled = 1;
    } else {
        /* Kahan's sum: in float a plain one drifts. Not to be compiled with -ffast-math. */
        const shapersmith_real added_s = cycle_time_s - shaper->lost_s;
        const shapersmith_real sum_s = shaper->elapsed_s + added_s;
        shaper->lost_s = (sum_s - shaper->elapsed_s) - added_s;
        shaper->elapsed_s = sum_s;
        shaper->calls += 1;
    }
    /* Written so that not-a-number fails. */
    if (!(cycle_time_s > SHAPERSMITH_C(0.0) && cycle_time_s <= $LONGESTC)) {
        shaper->error = 1;
    }
    if (!(wanted >= SHAPERSMITH_C(-1.0))) {
        wanted = wanted < SHAPERSMITH_C(-1.0) ? SHAPERSMITH_C(-1.0) : SHAPERSMITH_C(0.0);
    }
    if (wanted > SHAPERSMITH_C(1.0)) {
        wanted = SHAPERSMITH_C(1.0);
    }
    if (shaper->next >= shaper->plan.count && shaper->elapsed_s >= $SETTLED) {
        shaper->top = shaper->share;
$TAKE    }
$SEEN    shaper->kept = 0;
    if (shaper->error || !(shaper->length_m > SHAPERSMITH_C(0.0))) {
        shaper->kept = wanted != SHAPERSMITH_C(0.0);
        shaper->share = SHAPERSMITH_C(0.0);
        shaper->velocity_m_s = SHAPERSMITH_C(0.0);
        shaper->busy = 0;
        return;
    }
    if (wanted != shaper->target) {
        ${NAME}_motion now = shaper->motion;
        const ${NAME}_flow flow = ${NAME}_over(shaper, shaper->elapsed_s, shaper->set);
        shapersmith_real goal = wanted;
        int solved;
        ${NAME}_go(&now, &flow);
        solved = ${NAME}_replan(shaper, &now, goal, cycle_time_s);
        if (!solved && wanted * shaper->share < SHAPERSMITH_C(0.0)) {
            /* Stop first. */
            goal = SHAPERSMITH_C(0.0);
            solved = goal != shaper->target && ${NAME}_replan(shaper, &now, goal, cycle_time_s);
        }
        if (solved) {
            shaper->target = goal;
            shaper->next = 0;
            shaper->calls = 0;
        }
        shaper->kept = wanted != shaper->target;
    }
    if (shaper->next < shaper->plan.count && shaper->plan.at[shaper->next] <= shaper->calls) {
        const shapersmith_real level = shaper->plan.level[shaper->next];
        if (level != shaper->share) {
            const ${NAME}_flow flow = ${NAME}_over(shaper, shaper->elapsed_s, shaper->set);
            const int set = ${NAME}_set_of(shaper->share, level, shaper->set);
            ${NAME}_go(&shaper->motion, &flow);
            ${NAME}_switch(shaper, &shaper->motion, level - shaper->share, shaper->set, set);
            shaper->set = set;
            shaper->share = level;
            shaper->elapsed_s = SHAPERSMITH_C(0.0);
            shaper->lost_s = SHAPERSMITH_C(0.0);
            if (level * shaper->top < SHAPERSMITH_C(0.0)
                || SHAPERSMITH_ABS(level) > SHAPERSMITH_ABS(shaper->top)) {
                shaper->top = level;
            }
        }
        shaper->next += 1;
    }
    shaper->busy = shaper->next < shaper->plan.count;
    shaper->velocity_m_s = shaper->share * $SPEED;
}

""")


CALL = Template("""\
   How to call it, once a cycle of $CYCLE s:

     static ${NAME}_shaper crane;
     ${NAME}_step(&crane, enable, wanted, ${LENGTH}SHAPERSMITH_C($CYCLE));
     velocity_m_s = crane.velocity_m_s;""")

TAKE_LENGTH = Template("""\
        if (cable_length_m >= $SHORTEST && cable_length_m <= $LONGEST
            && cable_length_m != shaper->length_m) {
            ${NAME}_length(shaper, cable_length_m);
        }
""")

SEEN_LENGTH = Template("""\
    shaper->valid = cable_length_m >= $SHORTEST
                    && cable_length_m <= $LONGEST;
    shaper->held = !(cable_length_m == shaper->length_m);
""")

TAKE_NO_LENGTH = """\
        if (!(shaper->length_m > SHAPERSMITH_C(0.0))) {
            $NAME_length(shaper, SHAPERSMITH_C(1.0));
        }
"""
