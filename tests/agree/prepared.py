"""Whether exported C takes parameters or refuses them."""

import subprocess

import numpy as np
from compiled import cc

from lagrange_casadi import export

PREPARED = """#include <stdio.h>
#include "@.h"
int main(void) {
  static const double values[][COUNT] = {VALUES};
  static @_model model;
  @_parameters parameters = @_defaults;
  int k;
  for (k = 0; k < (int) (sizeof values/sizeof values[0]); ++k) {
SET    printf("%d\\n", (int) @_prepare(&model, &parameters));
  }
  return 0;
}
"""


def prepared(scene, values, folder):
    made = export(scene, folder)
    rows = ", ".join(
        "{" + ", ".join(f"{float(x)!r}" for x in np.atleast_1d(row)) + "}" for row in values
    )
    members = "".join(
        f"    parameters.{name} = values[k][{i}];\n"
        for i, name in enumerate(scene.mechanism.parameters)
    )
    text = (
        PREPARED.replace("COUNT", str(len(scene.mechanism.parameters)))
        .replace("VALUES", rows)
        .replace("SET", members)
    )
    (folder / "harness.c").write_text(text.replace("@", made.prefix))
    result = cc(["cc", "-std=c99"], folder, "harness.c", f"{made.prefix}.c")
    assert result.returncode == 0, result.stderr
    return [
        int(line) == 0
        for line in subprocess.run(
            [folder / "program"], capture_output=True, text=True, check=True
        ).stdout.split()
    ]
