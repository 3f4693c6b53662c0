"""Upper limits on what is read from a log of unknown origin, and what a name, a path and a word may be.

The limits are far above what a study needs; they keep an absurd or forged file from taking all memory or time.
"""

import re
import unicodedata

MAX_LOG_BYTES = 2**26
"""Size of a log, and of what all its chunks unpack to."""
MAX_IMAGE_BYTES = 2**24
"""Size of one encoded image of a log."""
MAX_MESSAGE_BYTES = 2**20
"""Size of any other message of a log."""
MAX_MESSAGES = 200_000
"""Messages on the documented topics of one log."""
MAX_PIXELS = 2**24
"""Width × height of an image."""
MAX_SENTENCE = 100
"""Words of a sentence of a log."""
MAX_TRIAL = 1_000_000
"""Largest number of a trial of a log."""

PATH_PATTERN = r"^[^\u0000-\u001f\u007f\ud800-\udfff]+$(?!\n)"
"""The path of a file that a config names: no control characters."""
_READ_AS_ELSE = ("NA", "N/A", "#NA", "#N/A", "<NA>", "nan", "null", "none", "true", "false", "inf", "infinity")
_NOT_READ_AS_ELSE = (
    rf"(?!(?:{'|'.join(''.join(f'[{c.lower()}{c}]' for c in text.upper()) for text in _READ_AS_ELSE)})$)"
)
NAME_PATTERN = rf"^{_NOT_READ_AS_ELSE}[A-Za-z][A-Za-z0-9_-]{{0,39}}$(?!\n)"
"""The name of an experiment or a variant, which is part of paths and stands in tables."""
NAME_RULE = "a letter, then up to 39 letters, digits, _ or -; not NA, nan, null, none, true, false, inf or infinity"
_INVISIBLE = (
    r"\s\u0000-\u001f\u007f-\u00a0\u00ad\u200b-\u200f\u202a-\u202e\u2060-\u206f\ud800-\udfff\ufeff\ufff0-\uffff"
)
WORD_PATTERN = rf"^{_NOT_READ_AS_ELSE}(?![=+@/-])(?!\.?[0-9][0-9.eE+-]*$)[^{_INVISIBLE}]{{1,40}}$(?!\n)"
"""A word, for JSON schema and for Python: 1 to 40 characters, all visible, none white space. It does not begin like a
formula, which a spreadsheet would run when it opens a table, or like a path; nor would a table be read as if a number
stood there, or nothing. `$` alone would let a line feed pass in Python."""
WORD_RULE = "1 to 40 visible characters, no number, not beginning with =, +, -, @ or /; not NA, nan, null, none, …"
_WORD = re.compile(WORD_PATTERN)


def normal(text: str) -> str:
    """A text in Unicode's normal form C, in which words are compared: an é is one letter, however it was typed."""
    return unicodedata.normalize("NFC", text)


def is_word(text: str) -> bool:
    """Whether a text may be a word."""
    return _WORD.search(text) is not None
