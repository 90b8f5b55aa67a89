"""What is built for a Cortex-M4F, run on the board mps2-an386 as an emulator has it, and measured
there.
"""

import re
import shutil
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from lagrange_casadi import export, load_case

HERE = Path(__file__).parent
COMPILER = "arm-none-eabi-gcc"
NM = "arm-none-eabi-nm"
SIZE = "arm-none-eabi-size"
EMULATOR = "qemu-system-arm"
CORE = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
FLAGS = (*CORE, "-ffp-contract=off", "-fno-math-errno")
# One instruction a nanosecond of the board's time, so that its SysTick, of 25 MHz, counts 40 of
# them.
MACHINE = (
    "-M",
    "mps2-an386",
    "-nographic",
    "-monitor",
    "none",
    "-serial",
    "none",
    "-icount",
    "shift=0",
)
SEMIHOSTING = ("-semihosting-config", "enable=on,target=native")
METHODS = {
    "single": {"precision": "single"},
    "double": {},
    "single, effort": {"precision": "single", "wanted": ["effort"]},
    "table 1e-6, effort": {"precision": "single", "wanted": ["effort"], "table": 1e-6},
}
_ON_DOUBLES = re.compile(r"__aeabi_(c?d\w+|[filu]+2d|cfc\w*)|__\w+df\d?")


def missing():
    """Why nothing can be built or run here, or an empty text."""
    absent = [tool for tool in (COMPILER, NM, SIZE, EMULATOR) if shutil.which(tool) is None]
    if absent:
        return f"there is no {absent[0]}"
    found = subprocess.run(
        [COMPILER, *CORE, "-print-file-name=librdimon.a"],
        capture_output=True,
        text=True,
        check=True,
    )
    return "" if "/" in found.stdout else "the cross compiler has no newlib with semihosting"


def run(*command, cwd=None):
    """What a command prints. Raises with what it complains about where it fails."""
    done = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        check=False,
        cwd=cwd,
        timeout=120,
    )
    if done.returncode:
        raise RuntimeError(f"{command[0]} answers {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


@dataclass(frozen=True)
class Target:
    """An exported folder, by its contract, optimized for the machine; instants of ``span`` (start,
    stop) [s] are measured.
    """

    folder: Path
    contract: object
    span: tuple[float, float]
    optimized: str = "-O2"

    @cached_property
    def _work(self):
        work = self.folder.parent / f"{self.folder.name}{self.optimized}"
        work.mkdir(exist_ok=True)
        return work

    @cached_property
    def object(self):
        """The mechanism's object; in single precision no double is meant, nor comes in by a
        promotion.
        """
        path = self._work / "mechanism.o"
        strict = ["-Wdouble-promotion", "-Wfloat-conversion"] if self.contract.rests else []
        flags = [
            *FLAGS,
            self.optimized,
            "-std=c99",
            "-pedantic",
            "-Wall",
            "-Wextra",
            "-Werror",
            *strict,
        ]
        run(COMPILER, *flags, "-c", self.folder / f"{self.contract.prefix}.c", "-o", path)
        return path

    @cached_property
    def whole(self):
        """The object with all that it needs of the libraries."""
        path = self._work / "whole.o"
        run(COMPILER, *CORE, "-nostdlib", "-r", self.object, "-lm", "-lc", "-lgcc", "-o", path)
        return path

    def program(self, source, *flags):
        """What a program with the object prints on the machine.

        Raises where it does not exit with 0.
        """
        image = self._work / f"{source.stem}.elf"
        linked = ["--specs=rdimon.specs", "-nostartfiles", "-T", HERE / "link.ld"]
        files = [HERE / "startup.c", source, self.object]
        run(
            COMPILER,
            *FLAGS,
            self.optimized,
            "-std=gnu99",
            "-I",
            self.folder,
            *flags,
            *files,
            *linked,
            "-lm",
            "-o",
            image,
        )
        return run(EMULATOR, *MACHINE, *SEMIHOSTING, "-kernel", image)

    def selftest(self):
        """The verdict of the folder's own self-test."""
        return self.program(self.folder / "selftest.c")

    @cached_property
    def measured(self):
        """Numbers by what they are: instructions a call, bytes of stack, bytes of structs."""
        c, (start, stop) = self.contract, self.span
        told = {
            "MECHANISM": c.prefix,
            "SETTINGS": len(c.settings),
            "RESTS": int(c.rests),
            "LINKS": len(c.links),
        }
        told |= {"START": f"{start!r}", "STEP": f"{(stop - start) / 64!r}"}
        lines = self.program(
            HERE / "measure.c", *(f"-D{key}={value}" for key, value in told.items())
        ).splitlines()
        return {name: int(value) for name, value in (line.rsplit(" ", 1) for line in lines)}

    def sections(self, path):
        """Bytes of code, constants and memory in an object."""
        found = {"text": 0, "rodata": 0, "data": 0, "bss": 0}
        for name, size in re.findall(r"^\.(\w+)\S*\s+(\d+)", run(SIZE, "-A", path), re.MULTILINE):
            if name in found:
                found[name] += int(size)
        return found

    @property
    def needed(self):
        """The functions that the object asks libraries for."""
        return {line.split()[-1] for line in run(NM, "-u", self.object).splitlines()}

    def doubles(self, path):
        """The library's arithmetic of doubles that an object has or asks for."""
        names = {line.split()[-1] for line in run(NM, path).splitlines()}
        return {name for name in names if _ON_DOUBLES.fullmatch(name)}

    @property
    def stated(self):
        """Bytes of stack, by the header."""
        header = (self.folder / f"{self.contract.prefix}.h").read_text()
        return int(re.search(r"^#define \w+_STACK (\d+)$", header, re.MULTILINE)[1])


def exported(name, method, folder, optimized="-O2"):
    """A case of the repository, exported into a folder."""
    loaded = load_case(Path(__file__).parents[3] / "cases" / name)
    agreed = export(loaded.scene, folder, name=loaded.name, **METHODS[method])
    return Target(folder, agreed, loaded.scene.t[:2], optimized)
