"""Structured text of IEC 61131-3, run: a small subset, one statement a line."""

import math
import re
from functools import partial


def truncated(x):
    """A number as one of DINT."""
    assert abs(x) < 2**31, x
    return math.trunc(x)


KNOWN = {
    "SQRT": math.sqrt,
    "SIN": math.sin,
    "COS": math.cos,
    "TAN": math.tan,
    "ASIN": math.asin,
    "ACOS": math.acos,
    "ATAN": math.atan,
    "EXP": math.exp,
    "LN": math.log,
    "ABS": abs,
    "EXPT": math.pow,
    "MIN": min,
    "MAX": max,
    "SEL": lambda choice, no, yes: yes if choice else no,
    "TRUNC": truncated,
    "DINT_TO_LREAL": float,
    "LREAL_TO_DINT": lambda x: truncated(round(x)),
}
WORDS = {"AND": "and", "OR": "or", "NOT": "not", "TRUE": "True", "FALSE": "False", "=": "=="}
WORDS |= {"<>": "!=", ":=": "="}
TOKEN = re.compile(r"\d+\.?\d*(?:E[-+]?\d+)?|[A-Za-z]\w*|:=|<>|<=|>=|\S")


def expression(text, functions):
    """An expression or assignment in Python; variables are members of ``s``."""
    found, tokens = [], TOKEN.findall(text)
    for k, token in enumerate(tokens):
        member = k > 0 and tokens[k - 1] == "."
        if token in WORDS:
            found.append(f" {WORDS[token]} ")
        elif not token[0].isalpha() or member:
            found.append(token)
        elif token in functions:
            found.append(f"f[{token!r}]")
        else:
            found.append(f"s.{token}")
    return "".join(found)


def python(lines, functions, units):
    """The lines of a body as those of Python."""
    depth, found = 1, []

    def say(text):
        found.append("  " * depth + text)

    for line in lines:
        if match := re.fullmatch(r"(IF|ELSIF) (.*) THEN", line):
            depth -= match[1] == "ELSIF"
            say(f"{'if' if match[1] == 'IF' else 'elif'} {expression(match[2], functions)}:")
            depth += 1
        elif line == "ELSE":
            depth -= 1
            say("else:")
            depth += 1
        elif match := re.fullmatch(r"FOR (\w+) := (.*) TO (.*) DO", line):
            low, high = (expression(match[k], functions) for k in (2, 3))
            say(f"for s.{match[1]} in range({low}, {high} + 1):")
            depth += 1
        elif line in ("END_IF;", "END_FOR;"):
            depth -= 1
        elif (match := re.fullmatch(r"(\w+)\((.*)\);", line)) and match[1] in units:
            given = [part.split(" := ") for part in match[2].split(", ")]
            values = ", ".join(f"{name}={expression(value, functions)}" for name, value in given)
            say(f"s.{match[1]}({values})")
        else:
            assert line.endswith(";"), line
            assert " := " in line, line
            say(expression(line[:-1], functions))
    return "\n".join(["def run(s, f):", *(found or ["  pass"])])


class Unit:
    """An instance of a block: its variables, and what it does when it is called."""

    def __init__(self, variables, body, functions):
        self.__dict__.update(variables())
        self.body, self.functions = body, functions

    def __call__(self, **given):
        assert set(given) <= set(self.__dict__)
        self.__dict__.update(given)
        self.body(self, self.functions)


def blocks(text):
    """Makers of a file's function blocks and programs by name."""
    text = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
    functions, made = dict(KNOWN), {}
    pattern = r"(FUNCTION_BLOCK|FUNCTION|PROGRAM) (\w+)(?: : LREAL)?\n(.*?)END_\1\n"
    for kind, name, inside in re.findall(pattern, text, re.DOTALL):
        declared = re.findall(r"VAR\w*\n(.*?)END_VAR\n", inside, re.DOTALL)
        parts = [x for part in declared for x in re.findall(r"(\w+) : (.*?);", part, re.DOTALL)]
        body = re.sub(r"VAR\w*\n.*?END_VAR\n", "", inside, flags=re.DOTALL)
        lines = [line.strip() for line in body.splitlines() if line.strip()]
        units = {variable for variable, type_ in parts if type_ in made}
        space = {}
        exec(python(lines, functions, units), space)
        variables = maker([*parts, (name, "LREAL")], made)
        unit = partial(Unit, variables, space["run"], functions)
        if kind == "FUNCTION":
            functions[name] = partial(called, unit, name, [variable for variable, _ in parts])
        else:
            made[name] = unit
    return made


def called(make, name, inputs, *given):
    """The value of a function."""
    unit = make()
    unit(**dict(zip(inputs, given, strict=True)))
    return getattr(unit, name)


def maker(parts, made):
    """What makes the variables of a block, with their values at the start."""

    def variables():
        found = {}
        for name, kind in parts:
            if array := re.match(r"ARRAY\[0\.\.(\d+)\] OF LREAL(?: := \[(.*)\])?", kind, re.DOTALL):
                values = [float(x) for x in array[2].split(",")] if array[2] else []
                assert len(values) in (0, int(array[1]) + 1)
                found[name] = values or [0.0] * (int(array[1]) + 1)
            else:
                known = {"LREAL": 0.0, "DINT": 0, "BOOL": False}
                found[name] = made[kind]() if kind in made else known[kind]
        return found

    return variables
