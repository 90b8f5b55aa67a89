"""Compare the number of the package's statements with the number in ``.ci/statements``.

Docstrings and imports do not count. The number only falls: a change that raises it fails, and a
change that lowers it writes the new number with ``--update``.
"""

import ast
import sys
from pathlib import Path

HERE = Path(__file__).parent
KEPT = HERE / "statements"


def count(path: Path) -> int:
    """Return how many statements a module has."""
    nodes = [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
    texts = [node for node in nodes if isinstance(node, ast.Expr) and _is_text(node.value)]
    imports = [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]
    return sum(isinstance(node, ast.stmt) for node in nodes) - len(texts) - len(imports)


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def main() -> None:
    """Exit with a status of 1 unless the numbers are equal."""
    now = sum(map(count, (HERE.parent / "lagrange_casadi").rglob("*.py")))
    if "--update" in sys.argv:
        KEPT.write_text(f"{now}\n")
    before = int(KEPT.read_text())
    print(f"statements of the package: {now}, in .ci/statements {before}")
    if now > before:
        sys.exit("there are more than before: delete what nothing needs")
    if now < before:
        sys.exit("there are fewer than before: python .ci/statements.py --update")


if __name__ == "__main__":
    main()
