
/* The outputs at an instant, and their exact derivatives by parameters. The time [s] is that of the instant:
   where the scene's motion depends on parameters, drives change with them as its laws do at that time. */
${p}_status ${p}_sensitivity(${p}_model* model, ${p}_real time, const ${p}_inputs* inputs,
$space            ${p}_outputs* outputs, ${p}_sensitivities* sensitivities);
