"""Model files that are hostile, some of them damaged too, drawn at random, and read: a program of
its own, for a reader may crash or hang.

``python tests drawn_models FIRST COUNT`` prints a number before each file, and a line for
whatever does not end in one line of the package's own error or in a case that works.
"""

import codecs
import json
import keyword
import random
import re
import signal
import sys
import warnings
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from damaging import damaged
from internals import case_of
from model_files import SMALL

from lagrange_casadi import evaluate, read
from lagrange_casadi.errors import LagrangeCasadiError

SECONDS, WAITING = 20, 200
"""What one file may take before the program ends itself: processor time, and time on a clock."""

MANY, FEW = 300, 30
"""Links of a case that is declared, and of one that is evaluated, at most."""

NUMBERS = [
    *("inf", "-inf", "nan", "1e400", "-1e308", "1e300", "1e-300", "5e-324", "1e13", "-1e12"),
    *("1e12", "1e6", "1e-6", "0", "-0.0", "-1", "9" * 400, "9" * 5000, "", " ", "1_0", "0x10"),
    *("1,5", "--1", "true", "null", "1e", "\u0661", "1e-160", "3.2e-9", "1e9", "1 2", "NaN"),
    *("Infinity", "-Infinity"),
]

_WORDS = sorted({word for text in SMALL.values() for word in re.findall(r"[A-Za-z_]\w*", text)})
NAMES = [
    *(*keyword.kwlist, *keyword.softkwlist, *dir(__builtins__), "ground", "world", "__model__"),
    *('"', "'''", '"""', "\\", "a\nb", "a\rb", "a\tb", "\u2028", "#", "{x}", "%s", "$(ls)", "../x"),
    *("n" * 100_000, "\u00e9" * 300, "\u4e2d", "\U0001f600", "\ufeff", "\u202e", "\x7f", "1", ""),
    *(" ", "a:b", "a.b", "a/b", "effort:x", "-x", "_", "__", "m", "ca", *_WORDS),
]

OURS = [
    *("scene", "m", "ca", "motion", "polynomial", "harmonic", "expression", "samples", "evaluate"),
    *("Mechanism", "SpatialMechanism", "Scene", "lagrange_casadi", "casadi", "t", "name", "length"),
    *("mass", "link", "point_mass", "at", "tip", "ground", "revolute", "weld", "gear", "parameter"),
]
"""Names that written cases use themselves."""

ENCODINGS = [
    *("rot13", "utf-16", "utf-7", "utf-32", "latin-1", "ascii", "hex", "zip", "idna", "cp037"),
    *("unicode_escape", "undefined", "none", "\u00e9", "x" * 5000, "shift_jis", "punycode"),
]

DOCTYPES = [
    '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;">]>',
    '<!DOCTYPE r SYSTEM "file:///etc/passwd">',
    '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///dev/zero">]>',
    "<?xml-stylesheet href='file:///etc/passwd'?>",
    "<![CDATA[",
    "&lt;&amp;&x;&#0;&#xD800;",
]


def law(chance, depth=0):
    """An expression of time, mostly one that Python must not evaluate."""
    kind = chance.randrange(3, 12) if depth < chance.randrange(1, 5) else chance.randrange(4)
    one, other = (law(chance, depth + 1) if kind > 3 else "t" for _ in range(2))
    many = int(10 ** chance.uniform(0, 4.2))
    return [
        chance.choice(["t", "time", "pi", "t", "2", "0.5", "9", "t", "(-8)", "1/3", "0"]),
        chance.choice(["t", "t", "1e12", "1e-300", "7", *NUMBERS]),
        chance.choice(
            ["t", "x", "__import__('os')", "t.real", "lambda: t", "[t]", "t if t else 1"]
        ),
        "^".join(chance.choices(["9", "9", "t", "2"], k=chance.randrange(2, 12))),
        f"({one}{chance.choice('+-*/^')}{other})",
        f"{one}^{other}",
        f"{chance.choice(['sin', 'exp', 'log', 'sqrt', 'acos', 'tan', 'f', 'abs'])}({one})",
        chance.choice("+-*/").join([one] * min(many, 9000 // (len(one) + 1))),
        "(" * many + one + ")" * many,
        "sin(" * min(many, 1900) + one + ")" * min(many, 1900),
        "(" * min(many, 1900) + one + "+1)^3" * min(many, 1900),
        "-" * many + one,
    ][kind]


def text_of(chance, depth=0):
    """An expression of t whose value is a number for positive t, as text."""
    kind = chance.randrange(9 if depth < 5 else 2)
    one, other = (text_of(chance, depth + 1) if kind > 1 else "" for _ in range(2))
    return [
        "t",
        chance.choice(["2", "0.5", "pi", "3", "1e-3", "7"]),
        f"({one} {chance.choice('+-*')} {other})",
        f"{one} {chance.choice('+-')} {other}",
        f"-{one}",
        f"sin({one})",
        f"({one})^{chance.randrange(4)}",
        f"({one}) / (1.5 + cos({other}))",
        f"({one}) * ({other})",
    ][kind]


def numbers(text, chance, told):
    """Some numbers in a text, hostile ones."""
    places = [*re.finditer(r"(?<![\w.])-?\d+(\.\d*)?(e-?\d+)?(?![\w.])", text)]
    for found in sorted(
        chance.sample(places, min(chance.choice([1, 1, 2, 9]), len(places))),
        key=lambda one: -one.start(),
    ):
        # That of another place makes two places one.
        new = chance.choice([chance.choice(NUMBERS), chance.choice(places)[0], "0"])
        if told == ".json" and chance.random() < 0.7:
            new = json.dumps(new) if not re.fullmatch(r"-?\d+(\.\d+)?(e-?\d+)?", new) else new
        text = text[: found.start()] + new + text[found.end() :]
    return text


def words(text, told):
    """The names in a text with the places where they stand."""
    if told == ".asmt":
        return [(one[1], one.span(1)) for one in re.finditer(r"Name\n\t+(\S+)", text)]
    pattern = r'"(\w+)"(?!\s*:)' if told == ".json" else r'(?:name|joint|link|joint1)="(\w+)"'
    return [(one[1], one.span(1)) for one in re.finditer(pattern, text)]


def renamed(text, chance, told):
    """A name of a text in all its places, or in one of them, another one."""
    if not (found := [one for one in words(text, told) if one[0]]):
        return text
    old, (start, stop) = chance.choice(found)
    new = chance.choice(chance.choice([NAMES, OURS]))
    if told == ".json":
        new = json.dumps(new)[1:-1]
    elif told != ".asmt" and chance.random() < 0.9:
        new = quoteattr(new, {'"': "&quot;", "'": "&apos;"})[1:-1]
    if chance.random() < 0.7:
        return re.sub(rf"(?<!\w){old}(?!\w)", lambda _: new, text)
    return text[:start] + new + text[stop:]


def piece(text, chance):
    """Where a piece of a text begins and ends: at elements, lists and lines."""
    places = [0, *(one.start() for one in re.finditer(r"[<{\[\n]", text)), len(text)]
    start = chance.randrange(len(places) - 1)
    return places[start], places[min(start + chance.choice([1, 1, 2, 9]), len(places) - 1)]


def nested(text, chance, told):
    """An element inside itself many times."""
    start, stop = piece(text, chance)
    inner, many = text[start:stop], int(10 ** chance.uniform(1, 4.5))
    if told == ".json":
        return text[:start] + "[" * many + inner + "]" * many + text[stop:]
    if told == ".asmt":
        lines = "".join("\t" * k + "Part\n" for k in range(min(many, 3000)))
        return text[:start] + lines + text[start:]
    name = chance.choice(["a", "link", "joint", "model", "body", "world", "frame", "include"])
    return text[:start] + f"<{name}>" * many + inner + f"</{name}>" * many + text[stop:]


def long(text, chance, *_):
    """A text with a place that is long: of blanks, or of a comment."""
    start, stop = piece(text, chance)
    at = chance.choice([start, stop])
    fill = chance.choice(["\n", " ", "\t\n", "x", "<!---->", "&#10;", "<a/>", "[],"])
    return text[:at] + fill * (int(10 ** chance.uniform(3, 6.3)) // len(fill)) + text[at:]


def hostile_law(text, chance, told):
    """A law of a text, another one."""
    new = law(chance)
    new = json.dumps(new)[1:-1] if told == ".json" else new
    pattern = (
        r'(?<=": ")[^"]*\bt(ime)?\b[^"]*(?=")' if told == ".json" else r"(?<=\t)[^\t\n]*time[^\n]*"
    )
    if not (found := [*re.finditer(pattern, text)]):
        return numbers(text, chance, told)
    at = chance.choice(found)
    return text[: at.start()] + new + text[at.end() :]


def doctype(text, chance, *_):
    """A text with a declaration of its own somewhere."""
    start = chance.choice([piece(text, chance)[0], text.find("<", 1)])
    return text[:start] + chance.choice(DOCTYPES) + text[start:]


def encoded(text, chance, *_):
    """A text that says of itself that it is of some encoding."""
    head = f'<?xml version="1.0" encoding="{chance.choice(ENCODINGS)}"?>\n'
    return head + text.partition("?>\n")[2]


HARMS = [*[numbers] * 3, *[renamed] * 2, nested, long, *[hostile_law] * 3]


def hostile(text, chance, told):
    """The content of a file that somebody made to do harm."""
    harms = HARMS if told in (".json", ".asmt") else [*HARMS, doctype, encoded]
    for _ in range(chance.choice([1, 1, 1, 2, 3])):
        text = chance.choice(harms)(text, chance, told)
    if chance.random() < 0.05:
        return codecs.encode(text, chance.choice(ENCODINGS[1:6]), "replace")
    return text.encode(errors="surrogatepass")


def drawn(seed):
    """A hostile file: its name and its content."""
    chance = random.Random(f"hostile {seed}")
    # Those of MuJoCo take longest.
    file = chance.choice([name for name in SMALL if not name.endswith(".xml")])
    file = "arm.xml" if seed % 25 == 0 else file
    content = hostile(SMALL[file], chance, Path(file).suffix)
    return file, damaged(content, chance) if seed % 4 == 1 and len(content) > 200 else content


def attempt(path, evaluated):
    """What is wrong with how a file is read, and perhaps evaluated; empty if nothing is. And
    whether it is a case.
    """
    accepted = False
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            text = case_of(path)
            compile(text, "case", "exec")
            links = text.count(" = m.link")
            scene = read(path) if links <= MANY else None
        accepted = True
        if links > FEW or not evaluated:
            return "", True
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = evaluate(scene, t=(*scene.span[:2], 3), wanted=["effort"], backend="vm")
        whole = all(np.isfinite(one).all() for one in found.outputs.values())
    except LagrangeCasadiError as error:
        line = str(error)
        return "" if line.isprintable() and len(line) > 10 else f"said {line!r}", accepted
    except Exception as error:
        return f"{type(error).__name__}: {error}", accepted
    return "" if whole else "evaluated, not finite", True


def run(first, count):
    """Draw and read so many files."""
    folder = Path.cwd()
    for seed in range(first, first + count):
        print(seed, flush=True)
        signal.alarm(WAITING)
        file, content = drawn(seed)
        path = folder / f"hostile.{file}"
        path.write_bytes(content)
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        wrong, accepted = attempt(path, evaluated=seed % 3 == 0)  # which takes longest
        signal.setitimer(signal.ITIMER_PROF, 0)
        if accepted:
            print("accepted", flush=True)
        if wrong:
            print(f"{seed} {file}: {wrong[:500]!r}", flush=True)
        path.unlink()


if __name__ == "__main__":
    run(int(sys.argv[1]), int(sys.argv[2]))
