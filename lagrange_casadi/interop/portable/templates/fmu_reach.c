
static ${p}_status ahead(const ${p}_model* model, double time, double place, ${p}_inputs* inputs, double* gap) {
  const ${p}_status status = motion(model, time, inputs);
  *gap = $sign($value - place);
  return status;
}

/* The scene's motion where ${coordinate} is at a place. It always goes one way: from the scene's times the search widens until the
   place is between two times, and halves them as long as doubles are between. */
static ${p}_status reach(const ${p}_model* model, double place, ${p}_inputs* inputs) {
  double low = $start, high = $stop, width = high - low, middle, gap, beyond;
  ${p}_status status;
  for (;; width *= 2) {
    status = ahead(model, low, place, inputs, &gap);
    if (status == ${P}_OK) status = ahead(model, high, place, inputs, &beyond);
    if (status != ${P}_OK) return status;
    if (!(gap > 0 || beyond < 0)) break;
    if (gap > 0 ? low <= $least : high >= $most) return ${P}_BAD_TIME;
    if (gap > 0) low = low - width > $least ? low - width : $least;
    else high = high + width < $most ? high + width : $most;
  }
  for (middle = low + (high - low)/2; low < middle && middle < high; middle = low + (high - low)/2) {
    status = ahead(model, middle, place, inputs, &gap);
    if (status != ${P}_OK) return status;
    if (gap < 0) low = middle; else high = middle;
  }
  status = motion(model, high, inputs);
$put
  return status;
}
