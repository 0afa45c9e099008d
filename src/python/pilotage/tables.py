"""Tables that the program writes (tiles.csv, fixes.csv, frames.csv, evaluation.csv) as numpy arrays."""

import csv
import os
import re

import numpy

from .errors import DataError


# "007" and "1_000" are texts.
_INTEGER = re.compile("-?(0|[1-9][0-9]{0,17})")
_NUMBER = re.compile("|[+-]?(0|[1-9][0-9]*)([.][0-9]*)?(e[+-]?[0-9]+)?|[+-]?[.][0-9]+(e[+-]?[0-9]+)?|nan|-?inf", re.IGNORECASE)


def _column(cells):
    """Integers where every cell is one, else floats with NaN for empty cells, else text."""
    if cells and all(_INTEGER.fullmatch(cell) for cell in cells):
        return numpy.array([int(cell) for cell in cells], dtype=numpy.int64)
    if all(_NUMBER.fullmatch(cell) for cell in cells):
        return numpy.array([float(cell or "nan") for cell in cells], dtype=numpy.float64)
    return numpy.array(cells, dtype=numpy.str_)


def read_table(path):
    """The rows of a table as a structured array, one field for each column of its header: int64, float64 or text.

    An empty cell is NaN in a column of numbers. `pandas.DataFrame(read_table(path))` makes a frame of it. Throws DataError for a file that
    is no such table.
    """
    name = os.fsdecode(path)
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
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
