"""Live shaping in C: plans as levels on calls, and the pulse that ends a swing."""

from string import Template

PLAN = Template("""\
/* Add a level to a plan: one at the same call is replaced. */
static inline void ${NAME}_add(${NAME}_plan *plan, long at, shapersmith_real level)
{
    if (plan->count == 0 || plan->at[plan->count - 1] != at) {
        plan->count += 1;
    }
    plan->at[plan->count - 1] = at;
    plan->level[plan->count - 1] = level;
}

/* Add a level that changes between two calls, as the mean over their cycle. */
static inline void ${NAME}_add_mean(
    ${NAME}_plan *plan, long at, shapersmith_real share, shapersmith_real wanted,
    shapersmith_real other)
{
    if (share < $SNAP) {
        share = SHAPERSMITH_C(0.0);
    }
    if (share > SHAPERSMITH_C(1.0) - $SNAP) {
        share = SHAPERSMITH_C(1.0);
    }
    ${NAME}_add(plan, at, wanted * (SHAPERSMITH_C(1.0) - share) + other * share);
}

/* The levels of a pulse between two times, in cycles after a wait. */
static inline void ${NAME}_pulse(
    ${NAME}_plan *plan, long wait, shapersmith_real from, shapersmith_real until,
    shapersmith_real wanted, shapersmith_real other)
{
    const long first = (long)from;
    const long last = (long)until;
    const shapersmith_real begun = from - (shapersmith_real)first;
    const shapersmith_real ended = until - (shapersmith_real)last;
    ${NAME}_add(plan, wait, wanted);
    if (first == last) {
        ${NAME}_add_mean(plan, wait + first, ended - begun, wanted, other);
    } else {
        ${NAME}_add_mean(plan, wait + first, SHAPERSMITH_C(1.0) - begun, wanted, other);
        if (last > first + 1) {
            ${NAME}_add(plan, wait + first + 1, other);
        }
        ${NAME}_add_mean(plan, wait + last, ended, wanted, other);
    }
    ${NAME}_add(plan, wait + last + 1, wanted);
}

/* What is left of a motion once a plan is over, from one of its levels on. */
static inline ${NAME}_motion ${NAME}_left(
    const ${NAME}_shaper *shaper, ${NAME}_motion motion, int set, shapersmith_real level,
    const ${NAME}_plan *plan, int from, shapersmith_real cycle_s)
{
    int entry;
    long at = plan->at[from];
    for (entry = from; entry < plan->count; ++entry) {
        const int new_set = ${NAME}_set_of(level, plan->level[entry], set);
        if (plan->at[entry] != at) {
            const ${NAME}_flow flow = ${NAME}_over(
                shaper, (shapersmith_real)(plan->at[entry] - at) * cycle_s, set);
            ${NAME}_go(&motion, &flow);
            at = plan->at[entry];
        }
        if (plan->level[entry] != level) {
            ${NAME}_switch(shaper, &motion, plan->level[entry] - level, set, new_set);
            set = new_set;
            level = plan->level[entry];
        }
    }
    return motion;
}

static inline shapersmith_real ${NAME}_size(const ${NAME}_motion *motion)
{
    return SHAPERSMITH_SQRT(motion->re * motion->re + motion->im * motion->im);
}

""")


SOLVE = Template("""\
/* One pulse that ends a motion: its times in cycles, from guesses. Returns whether what is left is
   within the bound; the plan is added to what has been planned. */
static inline int ${NAME}_solve(
    const ${NAME}_shaper *shaper, ${NAME}_motion start, int set, shapersmith_real level,
    shapersmith_real wanted, shapersmith_real other, shapersmith_real cycle_s, long wait,
    shapersmith_real from, shapersmith_real until, ${NAME}_plan *plan, shapersmith_real *residual)
{
    const int planned = plan->count;
    const int set_wanted = ${NAME}_set_of(level, wanted, set);
    const int set_other = ${NAME}_set_of(wanted, other, set_wanted);
    const int set_last = ${NAME}_set_of(other, wanted, set_other);
    /* No gap moves by more than an eighth of a period at once. */
    const shapersmith_real most = $EIGHTH / (shaper->turn * cycle_s);
    ${NAME}_motion first = start;
    shapersmith_real a = SHAPERSMITH_C(0.0), b = a, c = a, d = a, re = a, im = a;
    int iteration;
    if (wanted != level) {
        ${NAME}_switch(shaper, &first, wanted - level, set, set_wanted);
    }
    /* Newton's method with switches at any time: the rows of its matrix are a b and c d. */
    for (iteration = 0; iteration < ${UPPER}_ITERATIONS; ++iteration) {
        const ${NAME}_flow flow = ${NAME}_over(shaper, from * cycle_s, set_wanted);
        const ${NAME}_flow on = ${NAME}_over(shaper, (until - from) * cycle_s, set_other);
        ${NAME}_motion motion = first;
        ${NAME}_motion early, late;
        shapersmith_real size, move, step;
        ${NAME}_go(&motion, &flow);
        early = ${NAME}_slope(shaper, &motion, set_wanted);
        ${NAME}_switch(shaper, &motion, other - wanted, set_wanted, set_other);
        ${NAME}_switch(shaper, &early, SHAPERSMITH_C(0.0), set_wanted, set_other);
        /* A later begin shortens the pulse. */
        late = ${NAME}_slope(shaper, &motion, set_other);
        early.re -= late.re;
        early.im -= late.im;
        early.error -= late.error;
        early.rate -= late.rate;
        ${NAME}_go(&motion, &on);
        ${NAME}_go(&early, &on);
        late = ${NAME}_slope(shaper, &motion, set_other);
        ${NAME}_switch(shaper, &motion, wanted - other, set_other, set_last);
        ${NAME}_switch(shaper, &early, SHAPERSMITH_C(0.0), set_other, set_last);
        ${NAME}_switch(shaper, &late, SHAPERSMITH_C(0.0), set_other, set_last);
        a = early.re * cycle_s;
        b = late.re * cycle_s;
        c = early.im * cycle_s;
        d = late.im * cycle_s;
        re = motion.re;
        im = motion.im;
        size = a * d - b * c;
        if (!(SHAPERSMITH_ABS(size) > SHAPERSMITH_C(0.0))) {
            return 0;
        }
        if (SHAPERSMITH_ABS(re) + SHAPERSMITH_ABS(im) < $NEAR) {
            break;
        }
        move = (b * im - d * re) / size;
        step = (c * re - a * im) / size;
        if (!(SHAPERSMITH_ABS(move) < most && SHAPERSMITH_ABS(step) < most)) {
            const shapersmith_real large = SHAPERSMITH_ABS(move) > SHAPERSMITH_ABS(step)
                                               ? SHAPERSMITH_ABS(move) : SHAPERSMITH_ABS(step);
            move = move * (most / large);
            step = step * (most / large);
        }
        from += move;
        until += step;
        if (until < from) {
            until = from;
        }
        if (!(from > -SHAPERSMITH_C(4.0) * most && until < $FARTHEST * most)) {
            return 0;
        }
    }
    /* Broyden's method with levels as they are sent, a mean for each cycle. */
    {
        shapersmith_real size = a * d - b * c;
        const shapersmith_real ia = d / size, ib = -b / size, ic = -c / size, id = a / size;
        ${NAME}_motion motion;
        a = ia;
        b = ib;
        c = ic;
        d = id;
        if (from < SHAPERSMITH_C(0.0) && from > -SHAPERSMITH_C(0.5)) {
            from = SHAPERSMITH_C(0.0);
        }
        for (iteration = 0; iteration < ${UPPER}_CORRECTIONS; ++iteration) {
            shapersmith_real move, step, x, y, share;
            if (!(from >= SHAPERSMITH_C(0.0) && until >= from)) {
                return 0;
            }
            plan->count = planned;
            ${NAME}_pulse(plan, wait, from, until, wanted, other);
            motion = ${NAME}_left(shaper, start, set, level, plan, planned, cycle_s);
            *residual = ${NAME}_size(&motion);
            if (*residual <= shaper->limit) {
                return 1;
            }
            if (iteration > 0) {
                /* The inverse learns from what the last step did. */
                x = a * (motion.re - re) + b * (motion.im - im);
                y = c * (motion.re - re) + d * (motion.im - im);
                move = -(a * re + b * im);
                step = -(c * re + d * im);
                share = move * x + step * y;
                if (SHAPERSMITH_ABS(share) > $LEAST * (move * move + step * step)) {
                    const shapersmith_real e = (move - x) / share, f = (step - y) / share;
                    const shapersmith_real g = move * a + step * c, h = move * b + step * d;
                    a += e * g;
                    b += e * h;
                    c += f * g;
                    d += f * h;
                }
            }
            re = motion.re;
            im = motion.im;
            from -= a * re + b * im;
            until -= c * re + d * im;
        }
    }
    return 0;
}

""")
