"""Tables as numpy arrays."""

import pathlib
import tempfile
import unittest

import numpy
import pilotage


class Tables(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "table.csv")
            path.write_bytes(text.encode())
            return pilotage.read_table(path)

    def test_columns_have_their_types(self):
        table = self.read('id,share,status,note\n1,0.5,fix,\n2,,no_map,"a, b"\n')
        self.assertEqual(table.dtype["id"], numpy.int64)
        self.assertEqual(table["share"][0], 0.5)
        self.assertTrue(numpy.isnan(table["share"][1]))
        self.assertEqual(list(table["status"]), ["fix", "no_map"])
        self.assertEqual(list(table["note"]), ["", "a, b"])

    def test_empty_cells_make_floats_of_integers(self):
        table = self.read("id,none\n1,\n,\n")
        self.assertEqual(table.dtype["id"], numpy.float64)
        self.assertTrue(numpy.isnan(table["none"]).all())

    def test_digits_that_are_no_number_stay_as_they_are(self):
        table = self.read("\ufeffname,code,big,share\n007,1_000,123456789012345678901,1e-05\n012,2_000,1,-0.5\n")
        self.assertEqual(list(table["name"]), ["007", "012"])
        self.assertEqual(list(table["code"]), ["1_000", "2_000"])
        self.assertEqual(table["big"][0], 123456789012345678901.0)
        self.assertEqual(list(table["share"]), [1e-05, -0.5])

    def test_no_rows(self):
        self.assertEqual(len(self.read("id,share\n")), 0)

    def test_what_is_no_table(self):
        for text, pattern in (("", "is empty"), ("a,a\n1,2\n", "name each column once"), ("a,b\n1\n", "line 2 has 1 cells")):
            with self.assertRaisesRegex(pilotage.DataError, pattern):
                self.read(text)
        with self.assertRaisesRegex(pilotage.DataError, "nowhere.csv"):
            pilotage.read_table("nowhere.csv")


if __name__ == "__main__":
    unittest.main()
