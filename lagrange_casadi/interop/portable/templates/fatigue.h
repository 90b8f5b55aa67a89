/* Damage of a stress that is given step by step: rainflow counting in bounded memory, ASTM E1049-85, section 5.4.4.

   ${p}_fatigue_material steel = ${example};
   ${p}_fatigue counter = {0};
   ...at every step: ${p}_fatigue_add(&counter, &steel, stress);
   ...when it is asked: ${p}_fatigue_damage(&counter, &steel);

   The stress [Pa] is one with a sign, at one place: N/A and M/W of a section's forces. A swing is counted when it has closed; those
   that have not are the residue, of which each counts half (5.4.4.2), in ${p}_fatigue_damage alone. Damage is Miner's sum: means by
   Goodman, one in compression counts as none; lives by the material's S-N line. A part lasts until it is 1.

   Memory is ${P}_FATIGUE_DEPTH turning points. A residue that is deeper than that gives up its oldest swing, which counts half: it
   belongs to the largest swings, and these would count whole only after a swing that is larger still. Whatever is shallower is
   counted as if all was kept. */

#ifndef ${P}_FATIGUE_H
#define ${P}_FATIGUE_H

#include <math.h>

#ifndef ${P}_FATIGUE_DEPTH
#define ${P}_FATIGUE_DEPTH 64
#endif

typedef struct {
  double endurance; /* the amplitude that is borne for ever, or where not endless as often as the line ends [Pa] */
  double ultimate;  /* the strength that bears a mean alone [Pa] */
  double start;     /* the amplitude that is borne 1000 times [Pa] */
  double slope;     /* cycles are 1000 (amplitude/start)^slope */
  int endless;
} ${p}_fatigue_material;

${materials}

typedef struct {
  double points[${P}_FATIGUE_DEPTH]; /* turning points, the last of which still moves */
  int count;
  double damage; /* of all swings that have closed */
  double swings; /* how many, a half one counts half */
} ${p}_fatigue;

static inline double ${p}_fatigue_swing(const ${p}_fatigue_material* m, double a, double b, double times) {
  const double mean = 0.5*(a + b), left = 1.0 - (mean > 0.0 ? mean : 0.0)/m->ultimate;
  const double amplitude = 0.5*fabs(b - a);
  if (amplitude == 0.0) return 0.0;
  if (!(left > 0.0)) return INFINITY;
  if (m->endless && amplitude/left <= m->endurance) return 0.0;
  return times/(1e3*pow(amplitude/left/m->start, m->slope));
}

/* Give up the oldest turning point: the swing from there counts half. */
static inline void ${p}_fatigue_give_up(${p}_fatigue* f, const ${p}_fatigue_material* m) {
  int k;
  f->damage += ${p}_fatigue_swing(m, f->points[0], f->points[1], 0.5);
  f->swings += 0.5;
  for (k = 1; k < f->count; ++k) f->points[k - 1] = f->points[k];
  --f->count;
}

/* Count what has closed at the last turning point. */
static inline void ${p}_fatigue_close(${p}_fatigue* f, const ${p}_fatigue_material* m) {
  double* p = f->points;
  while (f->count > 2) {
    const int n = f->count;
    if (fabs(p[n - 1] - p[n - 2]) < fabs(p[n - 2] - p[n - 3])) return;
    if (n == 3) {
      ${p}_fatigue_give_up(f, m);
    } else {
      f->damage += ${p}_fatigue_swing(m, p[n - 3], p[n - 2], 1.0);
      f->swings += 1.0;
      p[n - 3] = p[n - 1];
      f->count = n - 2;
    }
  }
}

/* Add the next stress; 0 if it is not a finite number, which is left out. */
static inline int ${p}_fatigue_add(${p}_fatigue* f, const ${p}_fatigue_material* m, double stress) {
  double* p = f->points;
  if (!(stress - stress == 0.0)) return 0;
  if (f->count == 0) {
    p[f->count++] = stress;
    return 1;
  }
  if (stress == p[f->count - 1]) return 1;
  if (f->count > 1 && (stress > p[f->count - 1]) == (p[f->count - 1] > p[f->count - 2])) {
    p[f->count - 1] = stress;
    return 1;
  }
  ${p}_fatigue_close(f, m);
  if (f->count == ${P}_FATIGUE_DEPTH) ${p}_fatigue_give_up(f, m);
  p[f->count++] = stress;
  return 1;
}

/* The damage so far, with the residue. */
static inline double ${p}_fatigue_damage(const ${p}_fatigue* f, const ${p}_fatigue_material* m) {
  ${p}_fatigue whole = *f;
  int k;
  ${p}_fatigue_close(&whole, m);
  for (k = 1; k < whole.count; ++k) whole.damage += ${p}_fatigue_swing(m, whole.points[k - 1], whole.points[k], 0.5);
  return whole.damage;
}

#endif
