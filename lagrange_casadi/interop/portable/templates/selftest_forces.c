
/* $forces, of each link, at each ratio. */
static const double forces_at[INSTANTS][LINKS*RATIOS*$many] = {
$rows
};
static const double forces_off[LINKS*$many] = {$off};
static const double ratios[RATIOS] = {$ratios};
