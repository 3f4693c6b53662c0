"""Upper limits on what is read from Parquet and npz files of unknown origin."""

MAX_TABLE_BYTES = 2**30
"""Size of a Parquet file, packed and, by its footer, unpacked."""
MAX_TABLE_ROWS = 2_000_000
"""Rows of a Parquet file, and texts in one of its columns."""
MAX_TABLE_PARTS = 1000
"""Parquet files in a folder that is read as one table."""
MAX_TABLE_VALUES = 50_000_000
"""Numbers in one column of a Parquet file (rows × list length)."""
MAX_READER_BYTES = 6 * MAX_TABLE_BYTES
"""Address space of a process that reads such a Parquet file: the file, its columns, and copies of these."""
MAX_READER_SECONDS = 120
"""Seconds that it may take."""

MAX_VECTOR_LENGTH = 1000
"""Numbers of one vector of features; the model squares it."""
MAX_NUMBER = 1e9
"""Largest magnitude of one number of features; the model squares it."""
MAX_TEXT_BYTES = 160
"""Bytes of one text of a Parquet file: 40 characters of up to four bytes, see `WORD_PATTERN`."""

MAX_ARRAYS_BYTES = 2**33
"""What the arrays of one npz file unpack to: percepts of 1,000 trials take about 100 MB."""
MAX_ARRAYS_RATIO = 100
"""By how many times an npz file may grow when it is unpacked; percepts grow to less than ten times their size."""
PLAIN_ARRAYS_BYTES = 2**27
"""What unpacks to no more than this may grow by any factor."""
