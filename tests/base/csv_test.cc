#include "pilotage/base/csv.h"

#include <limits>

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Rows = std::vector<std::vector<std::string>>;

Rows rows_of(std::string_view text) {
  CsvReader reader("t.csv", text);
  Rows rows;
  for (std::vector<std::string> cells; reader.next(cells);) rows.push_back(cells);
  return rows;
}

std::string csv_error(std::string_view text) {
  return testing::error_of<DataError>([&] { rows_of(text); });
}

TEST(CsvReader, ReadsPlainCells) {
  EXPECT_THAT(rows_of("a,b\n1,\n,\n"), ElementsAre(ElementsAre("a", "b"), ElementsAre("1", ""), ElementsAre("", "")));
  EXPECT_THAT(rows_of("a"), ElementsAre(ElementsAre("a")));
  EXPECT_THAT(rows_of(" a , b"), ElementsAre(ElementsAre(" a ", " b")));
  EXPECT_THAT(rows_of(""), IsEmpty());
}

TEST(CsvReader, LineEndsByteOrderMarkAndEmptyLines) {
  EXPECT_THAT(rows_of("\xEF\xBB\xBF"
                      "a,b\r\n\r\n1,2\r\n\n"),
              ElementsAre(ElementsAre("a", "b"), ElementsAre("1", "2")));
  EXPECT_THAT(rows_of("a\rb\n"), ElementsAre(ElementsAre("a\rb"))) << "a carriage return alone ends no line";
}

TEST(CsvReader, QuotesHoldCommasLinesAndQuotes) {
  EXPECT_THAT(rows_of("\"a,b\",\"c\"\"d\",\"\"\r\n\"x\ny\",2\n"),
              ElementsAre(ElementsAre("a,b", "c\"d", ""), ElementsAre("x\ny", "2")));
}

TEST(CsvReader, LinesAreCountedThroughQuotesAndEmptyLines) {
  CsvReader reader("t.csv", "\n\"a\nb\"\nc\n");
  std::vector<std::string> cells;
  ASSERT_TRUE(reader.next(cells));
  EXPECT_EQ(reader.line(), 2);
  ASSERT_TRUE(reader.next(cells));
  EXPECT_EQ(reader.line(), 4);
  EXPECT_EQ(reader.where(), "t.csv: line 4: ");
  EXPECT_FALSE(reader.next(cells));
}

TEST(CsvReader, BadQuotesAreNamedWithTheirLine) {
  EXPECT_EQ(csv_error("a\n\"b"), "t.csv: line 2: a quote is not closed");
  EXPECT_EQ(csv_error("a\n\"b\"c,d"), "t.csv: line 2: text after the closing quote of \"b\"");
  EXPECT_EQ(csv_error("ab\"c\",d"), "t.csv: line 1: a quote inside the unquoted cell \"ab…\"");
}

TEST(CsvTable, NamesColumnsAndGivesRows) {
  CsvTable table("t.csv", "a,b\n1,2\n\n3,\n", "a table of letters");
  EXPECT_THAT(table.columns(), ElementsAre("a", "b"));
  EXPECT_THAT(*table.next(), ElementsAre("1", "2"));
  EXPECT_THAT(*table.next(), ElementsAre("3", ""));
  EXPECT_EQ(table.where(), "t.csv: line 4: ");
  EXPECT_EQ(table.next(), nullptr);
}

TEST(CsvTable, WrongTablesAreNamed) {
  const auto table_error = [](std::string_view text) -> std::string {
    try {
      CsvTable table("t.csv", text, "a table of letters");
      while (table.next() != nullptr) continue;
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(table_error("\n"), "t.csv: empty, expected a table of letters");
  EXPECT_EQ(table_error("a,b,a\n"), "t.csv: line 1: column \"a\" is a duplicate");
  EXPECT_EQ(table_error("a,b\n1,2\n1\n"), "t.csv: line 3: 1 cells, expected 2");
  EXPECT_EQ(table_error("a,b\n1,2,3\n"), "t.csv: line 2: 3 cells, expected 2");
}

TEST(CsvCell, QuotesOnlyWhatNeedsThem) {
  EXPECT_EQ(csv_cell("plain text"), "plain text");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("say \"x\""), "\"say \"\"x\"\"\"");
  EXPECT_EQ(csv_cell(" x"), "\" x\"");
  EXPECT_EQ(csv_cell(0.1), "0.1");
  EXPECT_EQ(csv_cell(std::numeric_limits<double>::quiet_NaN()), "");
}

TEST(CsvCell, EveryTextReadsBack) {
  Random random(seed_from_name("csv_cell"));
  constexpr std::string_view kLetters = "ab,\"\r\n \xC3\xA9";
  for (int round = 0; round < 2000; ++round) {
    Rows rows(1 + random.below(3));
    std::string text;
    for (auto& row : rows) {
      // The first cell is never empty: a line without a character is no row.
      row = {"x"};
      for (std::uint64_t cell = random.below(4); cell > 0; --cell) {
        std::string content;
        for (std::uint64_t i = random.below(6); i > 0; --i) content += kLetters[random.below(kLetters.size())];
        row.push_back(content);
      }
      for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? "," : "") + csv_cell(row[i]);
      text += "\n";
    }
    ASSERT_EQ(rows_of(text), rows) << text;
  }
}

}  // namespace
}  // namespace pilotage
