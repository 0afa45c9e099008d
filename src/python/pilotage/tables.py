"""Tables that the program writes (tiles.csv, fixes.csv, frames.csv, evaluation.csv) as numpy arrays."""

import csv
import os

import numpy

from .errors import DataError


def _column(cells):
    """Integers where every cell is one, else floats with NaN for empty cells, else text."""
    if cells and all(cells):
        try:
            return numpy.array([int(cell) for cell in cells], dtype=numpy.int64)
        except (ValueError, OverflowError):
            pass
    try:
        return numpy.array([float(cell) if cell else numpy.nan for cell in cells], dtype=numpy.float64)
    except ValueError:
        return numpy.array(cells, dtype=numpy.str_)


def read_table(path):
    """The rows of a table as a structured array, one field for each column of its header: int64, float64 or text.

    An empty cell is NaN in a column of numbers. `pandas.DataFrame(read_table(path))` makes a frame of it. Throws DataError for a file that
    is no such table.
    """
    name = os.fsdecode(path)
    try:
        with open(path, newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DataError(f"{name}: cannot be read as a table: {error}") from error
    except ValueError:
        raise DataError(f"{name}: is empty; a table begins with the names of its columns") from None
    if len(set(header)) != len(header) or not all(header):
        raise DataError(f"{name}: the first line does not name each column once")
    for number, row in enumerate(rows, start=2):
        if len(row) != len(header):
            raise DataError(f"{name}: line {number} has {len(row)} cells, the first line {len(header)}")
    columns = [_column([row[i] for row in rows]) for i in range(len(header))]
    table = numpy.empty(len(rows), dtype=[(title, column.dtype) for title, column in zip(header, columns)])
    for title, column in zip(header, columns):
        table[title] = column
    return table
