 Those of a section law are for _section, which is all you need.
$if not space
   They mean: axial = n0 + n1 mu0 + n2 mu1, shear = f0 + f1 mu0 + f2 mu1, bending = m0 + f0 (l - xi)
   + f1 (mu1 - xi mu0) + f2 (mu2 - xi mu1) at xi from the base, where mu0 is the mass from there to
   the tip, mu1 and mu2 its first and second moment about the base; and then what acts on the link
   at stations, where something joins or loads it between its ends, beyond xi.
$end space
$if space
   They mean: axial = n0 + n1 mu0 + n2 mu1, shear_y = fy0 + fy1 mu0 + fy2 mu1,
   shear_z = fz0 + fz1 mu0 + fz2 mu1, torsion = mx0,
   bending_z = mz0 + fy0 (l - xi) + fy1 (mu1 - xi mu0) + fy2 (mu2 - xi mu1),
   bending_y = my0 - fz0 (l - xi) - fz1 (mu1 - xi mu0) - fz2 (mu2 - xi mu1)
   at xi from the base, where mu0 is the mass from there to the tip, mu1 and mu2 its first and
   second moment about the base; and then what acts on the link at stations, where something joins
   or loads it between its ends, beyond xi.
$end space
$if loaded
   And then loads along the link; those beyond a section act on it: per length the sums
   of qn0, qn1, qn2, ... and of qf0, qf1, qf2, ... (in space qfy0, ... and qfz0, ...) times 1, s,
   s^2, ..., where s = (end - xi/l)/width is between 0 and 1.
$end loaded
$if thick
   And then the rotary inertia of slices, couples along the link: per length the sums of cx0, cx1,
   ..., of cy0, ... and of cz0, ... times 1, s, ...; those beyond a section change its torsion,
   bending_y and bending_z.
$end thick
