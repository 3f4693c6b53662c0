"""What people type into a config that YAML takes for something else, and what to write instead."""

from __future__ import annotations

import codecs
import re
import unicodedata
from collections.abc import Iterator

import yaml

ENCODINGS = (
    (codecs.BOM_UTF32_LE, "UTF-32"),
    (codecs.BOM_UTF32_BE, "UTF-32"),
    (codecs.BOM_UTF16_LE, "UTF-16"),
    (codecs.BOM_UTF16_BE, "UTF-16"),
)
MOST_LINES = 5
"""So many lines with odd characters are told."""
QUOTES = "\u2018\u2019\u201a\u201c\u201d\u201e\u00ab\u00bb\u300c\u300d"
_INT, _FLOAT = (f"tag:yaml.org,2002:{kind}" for kind in ("int", "float"))
_PLAIN_INT = re.compile(r"[-+]?(0|[1-9][0-9]*)")


def not_utf8(content: bytes, error: UnicodeDecodeError) -> str:
    """Why the bytes of a config are no text, and what helps."""
    known = next((name for mark, name in ENCODINGS if content.startswith(mark)), "")
    if not known and content[:200:2].count(0) + content[1:200:2].count(0) > 20:
        known = "UTF-16"
    line = content.count(b"\n", 0, error.start) + 1
    what = f"is {known}" if known else f"is not UTF-8 (line {line}, byte 0x{content[error.start]:02x})"
    return f"cannot be read: it {what}; save it as UTF-8 (editors call it encoding; or iconv -f ENCODING -t UTF-8)"


def odd_characters(text: str) -> Iterator[str]:
    """Lines of a text that is no YAML which hold characters that only look like YAML's own."""
    told = 0
    for number, line in enumerate(text.splitlines(), 1):
        indent = line[: len(line) - len(line.lstrip())]
        code = line.partition("#")[0]
        found = [
            f"{unicodedata.name(letter, 'a control character')} as a blank"
            for letter in indent
            if letter not in " \t"
        ]
        if "\t" in indent:
            found.append("a tab as a blank")
        if "\uff1a" in code and ": " not in code:
            found.append("a full-width colon; YAML wants ': '")
        if "\u3001" in code or "\uff0c" in code:
            found.append("a full-width comma; YAML wants ', '")
        if re.fullmatch(r"\s*[A-Za-z_]\w*:[^\s:/].*", code):
            found.append("no blank after the colon; YAML wants ': '")
        if found and told < MOST_LINES:
            told += 1
            yield f"line {number} has {', '.join(dict.fromkeys(found))}"


def read_as_else(tag: str, written: str) -> str:
    """What is wrong with a number that YAML reads in another way than people do; nothing if both agree.

    YAML 1.1 takes 012 for the octal 10, 12:30 for 750 seconds and 1_2 for 12.
    """
    if tag not in (_INT, _FLOAT):
        return ""
    plain = _PLAIN_INT.fullmatch(written) if tag == _INT else not re.search("[_:]", written)
    if plain:
        return ""
    value = yaml.safe_load(written)
    digits = written.lstrip("0") or "0"
    instead = f"{digits}, or " if written.isdigit() else ""
    return f"{written} is read as {value} by YAML (write {instead}{value}; a word in quotes: '{written}')"


def quoted(value: object) -> str:
    """What to do where a word was typed that YAML reads as something else; nothing for what was meant so."""
    if isinstance(value, bool):
        one, each = ("on", "on, yes and true") if value else ("off", "off, no and false")
        return f"YAML reads {each} without quotes so: put the word in quotes, as in '{one}'"
    if value is None:
        return "YAML reads null, ~ and nothing at all so: put the word in quotes, or leave it out"
    if isinstance(value, int | float):
        return "YAML reads a number: a word has letters"
    if hasattr(value, "isoformat"):
        return f"YAML reads a date: put the word in quotes, as in '{value}'"
    if isinstance(value, str) and value and value[0] in QUOTES:
        return "these quotes are a word processor's and part of the text: write ' or nothing"
    return ""


def number_of(value: object) -> str:
    """What to write instead of a text or a fraction that means a whole number; nothing where none is meant."""
    if isinstance(value, str):
        try:
            number = float(unicodedata.normalize("NFKC", value))
        except ValueError:
            return ""
    elif isinstance(value, float):
        number = value
    else:
        return ""
    return f"write {int(number)}" if number == number and abs(number) < 1e15 and number == int(number) else ""
