
/* The forces inside a link at the ratio xi = distance from the base / length, from 0 to 1, for outputs of this
   model; at a station, where they jump, those on its side towards the tip. */
${p}_status ${p}_section(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link,
$space        ${p}_real xi, ${p}_forces* forces);

/* The same at many ratios. Returns the first status that is not ${P}_OK, if any. */
${p}_status ${p}_sections(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link,
$space         long many, const ${p}_real* xi, ${p}_forces* forces);
