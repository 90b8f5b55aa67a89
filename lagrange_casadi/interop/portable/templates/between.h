
/* The status between two instants, step seconds apart, by their inputs: whether a loop passes a dead centre there, where it can go
   on in either assembly. Both instants must be ${P}_OK, after the last that was evaluated. Drives move as smoothly from one to the
   other as their coordinates, rates and accelerations allow; if step is 0, straight. */
${p}_status ${p}_between(${p}_model* model, const ${p}_inputs* before, const ${p}_inputs* after, ${p}_real step);
