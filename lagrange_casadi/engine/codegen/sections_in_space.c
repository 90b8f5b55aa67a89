/* The same of a link in space. Its law holds n0, n1, n2, fy0, fy1, fy2, mz0, fz0, fz1, fz2, my0, mx0, its loads station, n, fy, fz, mx,
   my, mz of each station. Either plane of bending is that of a planar link; a positive moment about z bends as one in the plane does, one
   about y the other way round.

   value becomes, of the axial force, the shear forces along y and z, torsion, the bending moments about y and z, and the resultants of
   shear and bending in turn, the force at the base, at the tip, on both sides of each station, and where it turns between two stations:
   torsion nowhere but where slices have rotary inertia, a resultant at its two largest summits. place becomes the ratios of where they turn, in that order, and of the
   stations. */

/* The forces of one plane among those of space: which force it is there, -1 for none, and its sign. */
static inline void designs_of_plane(const casadi_real* from, const casadi_real* where, int many, int turns, int sign, casadi_real** value,
                                    casadi_real** place) {
  int k;
  for (k = 0; k < many + turns; ++k) *(*value)++ = sign < 0 ? -from[k] : from[k];
  for (k = 0; k < turns; ++k) *(*place)++ = where[k];
}

/* room takes, of either plane, a law, loads, values and places; marks is for the stations. nodes are those of what is looked at: the
   resultants of shear and of bending, and with loads along the link the axial force and the shear, and the bending moment. */
static inline void designs_along_in_space(const designs_link* link, const designs_nodes* const* nodes, casadi_real* marks,
                                          casadi_real* room, casadi_real* value, casadi_real* place) {
  const int count = link->stations, parts = count + 1, many = 2 + 2*count, turns = link->spreads ? 2*parts : parts;
  const casadi_real* law = link->law;
  casadi_real *values[3], *places[3], torsion, at_tip, *from;
  designs_link planes[3];
  designs_between between;
  int k, s, j, bends;
  for (k = 0; k < (link->couple ? 3 : 2); ++k) {
    casadi_real *own = room, *acting = room + 7;
    room += 7 + 4*count;
    values[k] = room;
    places[k] = room + 3*many + 2*turns + 2*parts;
    room += 3*many + 4*turns + 4*parts + count;
    planes[k] = *link;
    planes[k].law = own;
    planes[k].loads = acting;
    if (k < 2) {
      for (j = 0; j < 3; ++j) own[j] = law[j];
      for (j = 0; j < 4; ++j) own[3 + j] = law[3 + 4*k + j];
      if (k) own[6] = -own[6];
      planes[k].across = 1 + k;
      planes[k].couple = link->couple ? 5 - k : 0;
      planes[k].back = k;
    } else {
      /* Torsion is looked at as an axial force, of couples about the axis. */
      for (j = 0; j < 7; ++j) own[j] = j ? 0 : law[11];
      planes[k].axial = planes[k].across = 3;
      planes[k].couple = 0;
    }
    for (s = 0; s < count; ++s) {
      const casadi_real* load = link->loads + 7*s;
      acting[4*s] = load[0];
      acting[4*s + 1] = k < 2 ? load[1] : load[4];
      acting[4*s + 2] = k < 2 ? load[2 + k] : 0;
      acting[4*s + 3] = k == 0 ? load[6] : k == 1 ? -load[5] : 0;
    }
    if (link->spreads) {
      designs_along_loaded(planes + k, nodes[2], nodes[3], marks, values[k], places[k]);
    } else {
      designs_along(planes + k, marks, values[k], places[k]);
    }
  }
  designs_of_plane(values[0], places[0], many, turns, 1, &value, &place);
  for (k = 0; k < 2; ++k) designs_of_plane(values[k] + many + turns, places[k] + turns, many, turns, 1, &value, &place);
  if (link->couple) designs_of_plane(values[2], places[2], many, turns, 1, &value, &place);
  for (s = -2; !link->couple && s < 2*count; ++s) {
    const casadi_real u = s == -2 ? 0 : s == -1 ? 1 : designs_on_link(link->loads[7*(s/2)]);
    const casadi_real edge = designs_section_edge(u, s > 0 && s % 2);
    torsion = law[11];
    for (j = 0; j < count; ++j) torsion = torsion + lanes_less(edge, link->loads[7*j], link->loads[7*j + 4], 0);
    *value++ = torsion;
  }
  for (k = 1; k >= 0; --k) {
    designs_of_plane(values[k] + 2*(many + turns), places[k] + 2*turns, many, 2*parts, k ? -1 : 1, &value, &place);
  }
  between.planes = planes;
  between.many = 2;
  for (bends = 0; bends < 2; ++bends) {
    for (j = 0; j < many; ++j) {
      from = values[0] + (1 + bends)*(many + turns) + j;
      at_tip = values[1][(1 + bends)*(many + turns) + j];
      *value++ = DESIGNS_ROOT(*from*(*from) + at_tip*at_tip);
    }
    between.force = 1 + bends;
    for (s = 0; s < parts; ++s) {
      casadi_real low = 0, high = 1, summit[2];
      if (s > 0) low = marks[s - 1];
      if (s < count) high = marks[s];
      between.middle = DESIGNS_HALF*(low + high);
      between.edge = designs_section_edge(low, 0);
      designs_summits_between(&between, nodes[bends], low, high, summit);
      for (k = 0; k < 2; ++k) {
        place[k*parts + s] = summit[k];
        value[k*parts + s] = designs_looked_at(&between, summit[k]);
      }
    }
    value += 2*parts;
    place += 2*parts;
  }
  for (s = 0; s < count; ++s) place[s] = designs_on_link(link->loads[7*s]);
}
