/* The slider-crank of the paper, written by hand: Newton-Euler of the free bodies in closed form, everything per instant.

   Signs and columns are those of the package. Crank: x = r c, y = r s. Rod: its tip is on y = 0, so its direction is
   (C, -S) with S = y / l, its base acceleration (ax, ay), its rate -spin and its acceleration -turn.

   Instants go by in blocks: sines first, then what calls the library, then straight-line arithmetic, all into rows that stay in
   cache; copies bring these to the columns, which lie far apart in memory. */

#include <math.h>
#include <string.h>

#define BLOCK 128
#define RUN 8
#define STRIDE (BLOCK + 8) /* so that rows do not fall on the same lines of the cache */
#define G 9.81
#define SPEED (25.0 * 3.141592653589793)
#define HALF_ALPHA (3.141592653589793 / 200.0)
#define ALPHA (2.0 * HALF_ALPHA)

enum { THETA, OMEGA, THETA2, PSI, PSI1, PSI2, X, X1, X2, AX, AY, PHI, EFFORT, OX, OY, FX, FY, BX, BY, GUIDE,
       CN0, CN1, CN2, CF0, CF1, CF2, RN0, RN1, RN2, RF0, RF1, RF2, ROWS, ZERO = -1 };

/* Where each column comes from: a row of the block, or nothing but zeros. */
static const int COLUMN[40] = {
    THETA, OMEGA, THETA2, PSI, PSI1, PSI2, X, X1, X2, ZERO, ZERO, THETA, AX, AY, PHI, X, ZERO, EFFORT, OX, OY, FX, FY, BX, BY, ZERO,
    GUIDE, CN0, CN1, CN2, CF0, CF1, CF2, ZERO, RN0, RN1, RN2, RF0, RF1, RF2, ZERO };

/* Sine and cosine without a branch, for |a| < 1e6: a = q pi + 2 x with pi in three parts, fdlibm's kernels for |x| <= pi/4, and the
   double angle. */
static inline void sine_cosine(double a, double *s, double *c)
{
    const double round = 6755399441055744.0;
    const double q = (a * 0.3183098861837907 + round) - round, odd = q - 2.0 * ((q * 0.5 + round) - round);
    const double x = 0.5 * (((a - q * 0x1.921fb544p+1) - q * 0x1.0b4611a4p-33) - q * 0x1.3198a2e037073p-68);
    const double z = x * x, sign = 1.0 - 2.0 * odd * odd;
    const double sx = x + x * z * (-1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04
        + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    const double cx = 1.0 - z * (0.5 - z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (
        2.48015872894767294178e-05 + z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09
        + z * -1.13596475577881948265e-11))))));
    const double two = sign * (sx + sx);
    *s = two * cx, *c = sign - two * sx;
}

void slider_crank_instants(long long n, const double *restrict t, const double *restrict p, double *restrict out)
{
    const double r = p[0], l = p[1], m1 = p[2], m2 = p[3], m3 = p[4];
    const double k = r / l, il = 1.0 / l, half = 0.5 * m2, third = m2 * l * l / 3.0, w1 = m1 * G, w2 = half * G, w3 = m3 * G;
    const double half1 = 0.5 * m1, arm = 0.5 * w1 * r, inertial = m1 * r * r / 3.0 * ALPHA;
    double row[ROWS][STRIDE], s[BLOCK], c[BLOCK], lx[BLOCK];

    for (int j = 0; j < 40; j++)
        if (COLUMN[j] == ZERO)
            memset(out + j * n, 0, (size_t)n * sizeof *out);
    for (int i = 0; i < BLOCK; i++)
        row[THETA][i] = row[OMEGA][i] = 0.0, row[THETA2][i] = ALPHA, row[CF2][i] = -ALPHA, lx[i] = l;
    for (long long start = 0; start < n; start += BLOCK) {
        const int size = n - start < BLOCK ? (int)(n - start) : BLOCK;
        for (int i = 0; i < size; i++) {
            const double u = t[start + i];
            row[THETA][i] = (HALF_ALPHA * u + SPEED) * u, row[OMEGA][i] = ALPHA * u + SPEED;
        }
        for (int i = 0; i < BLOCK; i++) {
            double sine, cosine;
            sine_cosine(row[THETA][i], &sine, &cosine);
            s[i] = sine, c[i] = cosine;
        }
        for (int i = 0; i < size; i++) {
            const double S = k * s[i], phi = -asin(S);
            row[PHI][i] = phi, row[PSI][i] = phi - row[THETA][i], lx[i] = l * sqrt(1.0 - S * S);
        }
        for (int i = 0; i < BLOCK; i++) {
            const double omega = row[OMEGA][i], square = omega * omega, inverse = 1.0 / lx[i], C = il * lx[i], S = k * s[i];
            const double x = r * c[i], y = r * s[i], ax = -(x * square + y * ALPHA), ay = x * ALPHA - y * square, up = ay + G;
            const double spin = x * omega * inverse, spin2 = spin * spin, turn = (ay + y * spin2) * inverse;
            const double x2 = ax - (lx[i] * spin2 + y * turn), bx = m3 * x2, pull = bx + half * ax;
            const double lever = (third * turn - pull * y) * inverse, by = lever - half * up;
            const double fx = pull + half * x2, fy = lever + w2, across = fx * s[i] - fy * c[i], psi1 = -(spin + omega);
            row[PSI1][i] = psi1, row[PSI2][i] = -ALPHA - turn;
            row[X][i] = x + lx[i], row[X1][i] = y * psi1, row[X2][i] = x2, row[AX][i] = x, row[AY][i] = y;
            row[EFFORT][i] = (arm * c[i] + inertial) - r * across;
            row[OX][i] = fx + half1 * ax, row[OY][i] = fy + half1 * ay + w1;
            row[FX][i] = fx, row[FY][i] = fy, row[BX][i] = bx, row[BY][i] = by, row[GUIDE][i] = w3 - by;
            row[CN0][i] = -(fx * c[i] + fy * s[i]), row[CN1][i] = -G * s[i], row[CN2][i] = square;
            row[CF0][i] = across, row[CF1][i] = -G * c[i];
            row[RN0][i] = by * S - bx * C, row[RN1][i] = up * S - ax * C, row[RN2][i] = spin2;
            row[RF0][i] = -(bx * S + by * C), row[RF1][i] = -(ax * S + up * C), row[RF2][i] = turn;
        }
        for (int j = 0; j < 40; j++)
            if (COLUMN[j] != ZERO)
                memcpy(out + j * n + start, row[COLUMN[j]], (size_t)size * sizeof *out);
    }
}

/* k values of a row: n0 + n1 v + n2 v^2 and so on, with v = 1 - xi the part of the rod beyond the section. */
static inline void section_row(int k, const double *restrict law, const double *restrict xi, double *restrict axial,
                               double *restrict shear, double *restrict bending)
{
    const double n0 = law[0], n1 = law[1], n2 = law[2], f0 = law[3], f1 = law[4], f2 = law[5];
    const double b1 = law[6], b2 = law[7], b3 = law[8];
    for (int j = 0; j < k; j++) {
        const double v = 1.0 - xi[j];
        axial[j] = n0 + v * (n1 + v * n2);
        shear[j] = f0 + v * (f1 + v * f2);
        bending[j] = v * (b1 + v * (b2 + v * b3));
    }
}

/* Axial, shear and bending of the rod, (3, n, k): coefficients per instant, then runs of a fixed length along the rod. */
void slider_crank_sections(long long n, long long k, const double *restrict t, const double *restrict p,
                           const double *restrict xi, double *restrict out)
{
    const double r = p[0], l = p[1], m2 = p[3], m3 = p[4], il = 1.0 / l, half = 0.5 * m2, third = m2 * l * l / 3.0;
    const double ml = m2 * l, halfl = half * l, halfll = halfl * l, sixthll = halfll / 3.0;
    double *axial = out, *shear = out + n * k, *bending = out + 2 * n * k;

    for (long long i = 0; i < n; i++, axial += k, shear += k, bending += k) {
        const double u = t[i], theta = (HALF_ALPHA * u + SPEED) * u, omega = ALPHA * u + SPEED, square = omega * omega;
        double s, c;
        sine_cosine(theta, &s, &c);
        const double x = r * c, y = r * s, S = il * y, C = sqrt(1.0 - S * S), lx = l * C, inverse = 1.0 / lx;
        const double ax = -(x * square + y * ALPHA), ay = x * ALPHA - y * square, up = ay + G;
        const double spin = x * omega * inverse, spin2 = spin * spin, turn = (ay + y * spin2) * inverse;
        const double bx = m3 * (ax - (lx * spin2 + y * turn)), pull = bx + half * ax;
        const double by = (third * turn - pull * y) * inverse - half * up, across = ax * S + up * C;
        const double f0 = -(bx * S + by * C);
        const double law[9] = { by * S - bx * C, m2 * (up * S - ax * C) + ml * spin2, -halfl * spin2,
                                f0, ml * turn - m2 * across, -halfl * turn,
                                l * f0, halfll * turn - halfl * across, -sixthll * turn };
        long long j = 0;
        for (; j + RUN <= k; j += RUN)
            section_row(RUN, law, xi + j, axial + j, shear + j, bending + j);
        section_row((int)(k - j), law, xi + j, axial + j, shear + j, bending + j);
    }
}
