#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pilotage {

// Numbers as people read them, the same in the verdict, the tables and the chart. NaN and infinity become words.

/// "850 m", "3.4 km"; "unknown" for NaN, "unbounded" for infinity.
std::string length_text(double length_m);

/// "61 m", "4.2 m" below ten; "unknown", "unbounded".
std::string error_text(double error_m);

/// "61 m > 50 m" or "31 m ≤ 50 m", with as many decimals as it takes to tell the two apart.
std::string comparison_text(double error_m, double limit_m);

/// "122 s", "14 min 5 s" from ten minutes.
std::string duration_text(double duration_s);

/// "87 %": rounded down, so that what is not complete never reads 100 %; "less than 1 %" where there is something.
std::string percent_text(double fraction);

/// "1.4 MiB", "812 bytes".
std::string bytes_text(double bytes);

/// "1 landmark", "76 landmarks".
std::string count_text(std::int64_t count, const std::string& one, const std::string& many);

/// "21 months", "1 month": rounded to whole ones.
std::string months_text(double months);

/// "+0.42", "−1.00"; what rounds to nothing is "+0.00".
std::string signed_text(double number, int decimals);

/// "2", "2 and 4", "2, 4 and 5".
std::string listed(const std::vector<std::string>& words);

/// `number` with `decimals` digits, "–" when it is not finite.
std::string number_text(double number, int decimals);

}  // namespace pilotage
