"""The same as the C99 consumer, through ctypes: what it needs it reads from export.json."""

import ctypes
import json
import sys
from pathlib import Path


def main(folder: str, library: str, *ratios: str) -> None:
    told = json.loads((Path(folder) / "export.json").read_text())
    real = ctypes.c_float if told["precision"] == "single" else ctypes.c_double
    single = told["precision"] == "single"

    def struct(name: str, members: list[str]) -> type[ctypes.Structure]:
        return type(name, (ctypes.Structure,), {"_fields_": [(member, real) for member in members]})

    inputs, outputs = (
        struct(kind, [row["name"] for row in told[kind]]) for kind in ("inputs", "outputs")
    )
    kinds = {"real": real, "unsigned": ctypes.c_uint, "int": ctypes.c_int}
    layout = [(row["name"], kinds[row["type"]] * row["count"]) for row in told["model"]]
    model = type("model", (ctypes.Structure,), {"_fields_": layout})()
    forces = struct("forces", ["axial", "shear", "bending"])
    loaded, p = ctypes.CDLL(library), told["prefix"]
    prepare, motion, evaluate = (
        getattr(loaded, f"{p}_{name}") for name in ("prepare", "motion", "evaluate")
    )
    message = getattr(loaded, f"{p}_message")
    message.restype = ctypes.c_char_p
    motion.argtypes = [ctypes.c_void_p, *[real] * (2 if single else 1), ctypes.c_void_p]

    def check(status: int) -> None:
        if status:
            sys.exit(message(status).decode())

    check(prepare(ctypes.byref(model), *([None] if told["parameters"] else [])))
    for line in sys.stdin:
        t, rest = (float(word) for word in line.split())
        given, found = inputs(), outputs()
        check(motion(ctypes.byref(model), *((t, rest) if single else (t,)), ctypes.byref(given)))
        check(evaluate(ctypes.byref(model), ctypes.byref(given), ctypes.byref(found)))
        values = [getattr(found, name) for name, _ in outputs._fields_]
        for number, _ in enumerate(told["links"]):
            section = getattr(loaded, f"{p}_section")
            section.argtypes = [
                ctypes.c_void_p,
                ctypes.c_void_p,
                ctypes.c_int,
                real,
                ctypes.c_void_p,
            ]
            for ratio in ratios:
                at = forces()
                check(
                    section(
                        ctypes.byref(model),
                        ctypes.byref(found),
                        number,
                        float(ratio),
                        ctypes.byref(at),
                    )
                )
                values += [at.axial, at.shear, at.bending]
        print(*(value.hex() for value in values))


if __name__ == "__main__":
    main(*sys.argv[1:])
