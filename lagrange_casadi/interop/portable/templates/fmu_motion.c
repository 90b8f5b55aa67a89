
/* The scene's motion at a time. */
static ${p}_status motion(const ${p}_model* model, double time, ${p}_inputs* inputs) {
  return ${p}_motion(model, $time, inputs);
}
