/* Steps that begin or end at rest: there curves are sought by themselves from where, or up to where, they are numbers. */
/* Times of such a step: its ends, beside these, and between. */
#define SEARCH_AROUND (SEARCH_INNER + 4)
/* How often what is between rest and motion is cut into nine. */
#define SEARCH_CUTS 40

/* Keep in a group the curves that are no numbers where its first one is none. */
static void search_alike(const search_now* now, signed char* group, int first, const search_real* columns, int many) {
  const int rows = search_rows(now);
  int j, k;
  for (k = first; k < now->curves->curves; ++k) {
    for (j = 0; group[k] && j < many; ++j) group[k] = (columns[j*rows + k] != columns[j*rows + k]) == (columns[j*rows + first] != columns[j*rows + first]);
  }
}

/* Where a group is a number next to where it is none, as near as sides are; the column there. */
static double search_begins(search_now* now, double none, double some, signed char* group, int first, search_real* column,
                            search_real* columns) {
  const double beside = search_beside(now, &now->all);
  const int rows = search_rows(now);
  double t[SEARCH_INNER], width;
  int cut, j;
  for (cut = 0; cut < SEARCH_CUTS && !(some - none <= beside && none - some <= beside); ++cut) {
    width = (some - none)/(SEARCH_INNER + 1);
    for (j = 0; j < SEARCH_INNER; ++j) t[j] = none + (j + 1)*width;
    search_columns_at(now, t, SEARCH_INNER, columns);
    search_alike(now, group, first, columns, SEARCH_INNER);
    for (j = SEARCH_INNER - 1; j >= 0 && columns[j*rows + first] == columns[j*rows + first]; --j) {
      some = t[j];
      memcpy(column, columns + j*rows, (size_t) rows*sizeof *column);
    }
    if (j >= 0) none = t[j];
  }
  return some;
}

/* Search what of a step a group of curves is a number in: between two of the times around it at which it is, as far as it goes. */
static void search_between_rests(search_now* now, const double* t, int from, int to, signed char* group, int first,
                                 const search_real* columns, search_real* room) {
  const int rows = search_rows(now);
  search_real *begin = room, *end = room + rows;
  double start = t[from], stop = t[to];
  memcpy(begin, columns + from*rows, (size_t) rows*sizeof *begin);
  memcpy(end, columns + to*rows, (size_t) rows*sizeof *end);
  if (from > 0) start = search_begins(now, t[from - 1], start, group, first, begin, room + 2*rows);
  if (to < SEARCH_AROUND - 1) stop = search_begins(now, t[to + 1], stop, group, first, end, room + 2*rows);
  now->sought = group;
  search_note_all(now, start, begin);
  search_note_all(now, stop, end);
  if (now->left <= 0) {
    for (; first < now->curves->curves; ++first) now->peaks[now->quantity[first]].untold |= group[first];
  } else if (stop - start > 2*search_beside(now, &now->all)) {
    --now->left;
    search_part(now, start, stop, begin, end, 0);
  }
  now->sought = 0;
}

/* Search a step between instants for curves that rest, in groups that rest at the same times. */
static void search_step_beside_rest(search_now* now, long long step, signed char* resting, signed char* group) {
  const search_panel* all = &now->all;
  const int rows = search_rows(now), curves = (int) now->curves->curves;
  const double start = all->t[step], stop = all->t[step + 1], beside = search_beside(now, all), width = (stop - start)/(SEARCH_INNER + 1);
  search_real *columns = now->columns + 5*SEARCH_DEEPEST*rows, *room = columns + SEARCH_AROUND*rows, *ends[2];
  double t[SEARCH_AROUND];
  int first, from, j, k;
  if (!(stop - start > 8*beside)) return;
  t[0] = start;
  t[1] = start + beside;
  for (j = 1; j <= SEARCH_INNER; ++j) t[1 + j] = start + j*width;
  t[SEARCH_AROUND - 2] = stop - beside;
  t[SEARCH_AROUND - 1] = stop;
  search_columns_at(now, t + 1, SEARCH_AROUND - 2, columns + rows);
  ends[0] = columns;
  ends[1] = columns + (SEARCH_AROUND - 1)*rows;
  for (j = 0; j < 2; ++j) {
    search_column(now, all, step + j, ends[j]);
    for (k = 0; k < curves; ++k) if (search_nothing(ends[j][k])) ends[j][k] = (search_real) NAN;
  }
  for (first = 0; first < curves; ++first) {
    while (resting[first]) {
      memcpy(group, resting, (size_t) curves);
      memset(group, 0, (size_t) first);
      search_alike(now, group, first, columns, SEARCH_AROUND);
      for (from = 0; from < SEARCH_AROUND; from = j) {
        for (j = from; j < SEARCH_AROUND && columns[j*rows + first] == columns[j*rows + first]; ++j) {}
        if (j > from) search_between_rests(now, t, from, j - 1, group, first, columns, room);
        else ++j;
      }
      for (k = first; k < curves; ++k) resting[k] &= !group[k];
    }
  }
}

/* Whether friction at rest leaves curves open in a step between instants, of those that have numbers at others: which, and whether all
   rest at both ends. */
static int search_resting(const search_now* now, long long step, signed char* resting) {
  const search_real* row;
  int k, any = 0, moves = 0;
  for (k = 0; k < now->curves->curves; ++k) {
    row = search_row(&now->all, k) + step;
    resting[k] = !now->none[k] && !now->peaks[now->quantity[k]].open && search_rests(now, k, step);
    any |= resting[k];
    moves |= resting[k] && !(search_nothing(row[0]) && search_nothing(row[1]));
  }
  return any ? moves ? 2 : 1 : 0;
}

/* Search all steps beside rest. One that rests at both ends may move in its middle. */
static void search_beside_rest(search_now* now) {
  signed char *resting = now->resting, *group = resting + now->curves->curves;
  search_real* middle = now->columns;
  double t;
  long long i;
  int k, kind;
  for (i = 0; i < now->n - 1; ++i) {
    kind = search_resting(now, i, resting);
    if (kind == 1) {
      t = (now->t[i] + now->t[i + 1])/2;
      search_columns_at(now, &t, 1, middle);
      for (k = 0; k < now->curves->curves; ++k) resting[k] &= middle[k] == middle[k];
    }
    for (k = 0; kind && k < now->curves->curves; ++k) {
      if (!resting[k]) continue;
      search_step_beside_rest(now, i, resting, group);
      break;
    }
  }
}
