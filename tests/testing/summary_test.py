"""summary.py counts GoogleTest cases and other tests, tells why tests were skipped, and fails when anything did."""

import contextlib
import io
import json
import pathlib
import tempfile
import unittest

import summary

JUNIT = """<testsuite>
  <testcase name="geo.unit" status="run"/>
  <testcase name="match.unit" status="{match}"/>
  <testcase name="lint.layers" status="run"/>
  <testcase name="accept.slurm_array" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/>
    <system-out>looking for slurm&#10;skipped: slurmd is not installed&#10;</system-out></testcase>
  {more}
</testsuite>"""

GEO = """<testsuites><testsuite name="Frame">
  <testcase name="IsLocal" classname="Frame" status="run" result="completed"/>
  <testcase name="NeedsImagery" classname="Frame" status="run" result="skipped">
    <skipped message="frame_test.cc:7&#10;no real imagery"/></testcase>
  <testcase name="IsRound" classname="Frame" status="run" result="completed"/>
</testsuite></testsuites>"""

BAD_GEO = """<testsuites><testsuite name="Frame">
  <testcase name="IsLocal" classname="Frame" status="run" result="completed"/>
  <testcase name="IsRound" classname="Frame" status="run" result="completed"><failure message="flat"/></testcase>
</testsuite></testsuites>"""


class Summary(unittest.TestCase):
    def tell(self, junit, left_out=None, thorough=None, **cases):
        """The exit code and the lines for a run of ctest and the XML of its GoogleTest programs."""
        with tempfile.TemporaryDirectory() as folder:
            testing = pathlib.Path(folder)
            (testing / "cases").mkdir()
            if junit:
                (testing / "junit.xml").write_text(junit, encoding="utf-8")
            if left_out:
                (testing / "left_out.json").write_text(json.dumps(left_out), encoding="utf-8")
            if thorough:
                told = {"tests": [{"name": name} for name in thorough]}
                (testing / "thorough.json").write_text(json.dumps(told), encoding="utf-8")
            for name, text in cases.items():
                (testing / f"cases/{name}.unit.xml").write_text(text, encoding="utf-8")
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                code = summary.main(folder)
        return code, said.getvalue().splitlines()

    def test_cases_and_other_tests_are_counted(self):
        code, lines = self.tell(JUNIT.format(match="run", more=""), geo=GEO)
        self.assertEqual(lines[-1], "4 passed, 0 failed, 2 skipped")
        self.assertEqual(code, 0)

    def test_reasons_are_told(self):
        _, lines = self.tell(JUNIT.format(match="run", more=""), geo=GEO)
        self.assertEqual(lines[lines.index("  no real imagery") + 1], "    geo.unit: Frame.NeedsImagery")
        self.assertEqual(lines[lines.index("  slurmd is not installed") + 1], "    accept.slurm_array")

    def test_a_failed_case_is_named(self):
        code, lines = self.tell(JUNIT.format(match="run", more=""), geo=BAD_GEO)
        self.assertIn("  geo.unit: Frame.IsRound", lines)
        self.assertEqual((code, lines[-1]), (1, "3 passed, 1 failed, 1 skipped"))

    def test_a_program_that_dies_has_failed(self):
        code, lines = self.tell(JUNIT.format(match="fail", more=""), geo=GEO)
        self.assertIn("  match.unit", lines)
        self.assertEqual((code, lines[-1]), (1, "3 passed, 1 failed, 2 skipped"))

    def test_a_program_that_dies_after_its_cases_has_failed(self):
        code, lines = self.tell(JUNIT.format(match="fail", more=""), geo=GEO, match=GEO)
        self.assertIn("  match.unit", lines)
        self.assertEqual((code, lines[-1]), (1, "5 passed, 1 failed, 3 skipped"))

    def test_a_test_that_could_not_be_started_has_failed(self):
        more = '<testcase name="fuzz.map" status="notrun"><skipped message="Unable to find executable"/></testcase>'
        code, lines = self.tell(JUNIT.format(match="run", more=more), geo=GEO)
        self.assertEqual((code, lines[-1]), (1, "4 passed, 1 failed, 2 skipped"))

    def test_what_ran_before_is_counted_and_told(self):
        code, lines = self.tell(JUNIT.format(match="run", more=""), left_out={"base.unit": 70, "cli.help": 1}, geo=GEO)
        self.assertEqual((code, lines[-1]), (0, "75 passed, 0 failed, 2 skipped"))
        self.assertTrue(lines[-3].startswith("71 of the passed ones, in 2 tests, ran before"), lines[-3])

    def test_tiers_are_told_when_both_ran(self):
        more = '<testcase name="accept.install" status="run"/>'
        _, lines = self.tell(JUNIT.format(match="run", more=more), thorough=["accept.install"], geo=GEO)
        self.assertEqual(lines[-4:-2], ["First tier, 4 tests: 4 passed, 0 failed, 2 skipped",
                                        "Second tier, 1 tests: 1 passed, 0 failed, 0 skipped"])
        self.assertEqual(lines[-1], "5 passed, 0 failed, 2 skipped")

    def test_nothing_run_is_a_failure(self):
        for junit in ("<testsuite/>", None):
            code, lines = self.tell(junit)
            self.assertEqual((code, lines[-1]), (1, "0 passed, 0 failed, 0 skipped"))


if __name__ == "__main__":
    unittest.main()
