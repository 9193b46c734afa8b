#include "engine/import/volumes/slice_order.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "engine/core/error.hpp"

namespace sulcus {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// A number as a name writes it.
struct Decimal {
  std::string whole, fraction;  // without zeros ahead and behind
  std::string digits;           // of the fraction, all that are written
  bool minus = false;

  double value() const {
    const std::string text = (minus ? "-" : "") + (whole.empty() ? "0" : whole) + "." +
                             (fraction.empty() ? "0" : fraction);
    double number = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
  }
  std::string text() const {
    std::string result = (minus ? "-" : "") + (whole.empty() ? std::string("0") : whole);
    return fraction.empty() ? result : result + "." + fraction;
  }
  bool operator==(const Decimal& other) const {
    return whole == other.whole && fraction == other.fraction && minus == other.minus;
  }
};

std::string without_zeros_ahead(std::string digits) {
  return digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size()));
}

bool less(const Decimal& a, const Decimal& b) {
  if (a.minus != b.minus) return a.minus;
  const auto size_less = [](const Decimal& p, const Decimal& q) {
    if (p.whole.size() != q.whole.size()) return p.whole.size() < q.whole.size();
    return std::pair(p.whole, p.fraction) < std::pair(q.whole, q.fraction);
  };
  return a.minus ? size_less(b, a) : size_less(a, b);
}

/// A file and what its name is made of: texts with numbers between them.
struct NamedSlice {
  std::string file, name;
  std::vector<std::string> texts;
  std::vector<Decimal> numbers;
};

NamedSlice parsed(const std::string& file) {
  NamedSlice slice{file, std::filesystem::path(file).filename().string(), {std::string()}, {}};
  const std::string stem = std::filesystem::path(file).stem().string();
  for (std::size_t at = 0; at < stem.size();) {
    if (!is_digit(stem[at])) {
      slice.texts.back() += stem[at++];
      continue;
    }
    Decimal number;
    std::size_t end = at;
    while (end < stem.size() && is_digit(stem[end])) ++end;
    number.whole = stem.substr(at, end - at);
    // One dot makes it a decimal number; several part whole ones, as in an identifier.
    std::size_t fraction_end = end + 1;
    while (fraction_end < stem.size() && is_digit(stem[fraction_end])) ++fraction_end;
    const bool dotted_before = at >= 2 && stem[at - 1] == '.' && is_digit(stem[at - 2]);
    const bool dotted_behind = fraction_end + 1 < stem.size() && stem[fraction_end] == '.' &&
                               is_digit(stem[fraction_end + 1]);
    if (end < stem.size() && stem[end] == '.' && fraction_end > end + 1 && !dotted_before &&
        !dotted_behind) {
      number.digits = stem.substr(end + 1, fraction_end - end - 1);
      number.fraction = number.digits;
      while (!number.fraction.empty() && number.fraction.back() == '0') number.fraction.pop_back();
      end = fraction_end;
    }
    number.whole = without_zeros_ahead(number.whole);
    slice.numbers.push_back(std::move(number));
    slice.texts.emplace_back();
    at = end;
  }
  return slice;
}

/// Whether a text ends in a sign and not in a hyphen between words: "z_-", not "slice-".
bool may_be_minus(const std::string& text) {
  return text.ends_with('-') &&
         (text.size() == 1 || (!is_letter(text[text.size() - 2]) && text[text.size() - 2] != '-'));
}

/// Where some names have a minus ahead of a number and others do not, it is one.
void take_signs(std::vector<NamedSlice>& slices) {
  for (std::size_t n = 0; n < slices.front().numbers.size(); ++n) {
    const auto with = std::ranges::count_if(
        slices, [&](const NamedSlice& s) { return may_be_minus(s.texts[n]); });
    if (with == 0 || with == std::ssize(slices)) continue;
    for (NamedSlice& slice : slices) {
      if (!may_be_minus(slice.texts[n])) continue;
      slice.texts[n].pop_back();
      slice.numbers[n].minus = true;
    }
  }
}

/// Whether there are three or more numbers, in steps that are the same but for `rounding`.
bool are_even(std::vector<double> numbers, double rounding) {
  std::ranges::sort(numbers);
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (std::size_t n = 0; n + 1 < numbers.size(); ++n) {
    least = std::min(least, numbers[n + 1] - numbers[n]);
    most = std::max(most, numbers[n + 1] - numbers[n]);
  }
  return numbers.size() > 2 && least > 0.0 && most <= (1.0 + rounding) * least;
}

/// What the numbers at place `n` may be. Nobody writes 1.8, 1.9, 1.10 of decimal numbers, nor 0.75,
/// 1.00, 1.25 of parts: what goes in even steps is meant.
enum class DotMeaning { kDecimal, kPart, kUnknown };
DotMeaning meaning_of_dot(const std::vector<NamedSlice>& slices, std::size_t n) {
  std::map<std::string, double> decimals;  // by how they are written
  std::map<double, int> parts;
  std::set<std::size_t> lengths;
  bool padded = false, all_dotted = true;
  for (const NamedSlice& slice : slices) {
    const Decimal& number = slice.numbers[n];
    const std::size_t length = number.digits.size();
    if (length == 0) all_dotted = false;
    if (length > 0) lengths.insert(length);
    padded = padded || (length > 1 && number.digits.back() == '0');
    decimals[number.whole + "." + number.digits] = number.value();
    double part = 0.0;
    std::from_chars(number.digits.data(), number.digits.data() + length, part);
    ++parts[part];
  }
  if (!padded || lengths.size() < 2) return DotMeaning::kDecimal;
  std::vector<double> values, whole;
  values.reserve(decimals.size());
  whole.reserve(parts.size());
  for (const auto& [text, value] : decimals) values.push_back(value);
  for (const auto& [part, count] : parts) whole.push_back(part);
  constexpr double kDigits = 0.5, kNone = 1e-9;  // digits of a decimal number may be rounded
  const bool as_decimals = are_even(values, kDigits);
  const bool as_parts = all_dotted && are_even(whole, kNone);
  if (as_decimals == as_parts) return DotMeaning::kUnknown;
  return as_decimals ? DotMeaning::kDecimal : DotMeaning::kPart;
}

/// Where what stands behind a dot is a number of its own, as in v1.9 and v1.10, it becomes one.
/// @throws InputError: it may be one or the digits of a decimal number.
void part_at_dots(const std::string& folder, std::vector<NamedSlice>& slices) {
  for (std::size_t n = slices.front().numbers.size(); n-- > 0;) {
    const DotMeaning meaning = meaning_of_dot(slices, n);
    if (meaning == DotMeaning::kDecimal) continue;
    const auto at = static_cast<std::ptrdiff_t>(n) + 1;
    for (NamedSlice& slice : slices) {
      const std::string digits = std::exchange(slice.numbers[n].digits, {});
      slice.numbers[n].fraction.clear();
      if (meaning == DotMeaning::kPart) {
        slice.texts.insert(slice.texts.begin() + at, ".");
        slice.numbers.insert(slice.numbers.begin() + at,
                             {.whole = without_zeros_ahead(digits), .fraction = {}, .digits = {}});
      } else if (digits.size() > 1 && digits.back() == '0') {
        throw InputError(folder, "",
                         slice.name + ", where " + digits + " may be a number or a fraction",
                         "numbers with as many digits in each name");
      }
    }
  }
}

}  // namespace

void warn_of_gaps(std::span<const SliceNumber> slices, std::vector<std::string>& warnings) {
  double least = std::numeric_limits<double>::infinity();
  const auto step = [&](std::size_t s) { return slices[s + 1].value - slices[s].value; };
  for (std::size_t s = 0; s + 1 < slices.size(); ++s) least = std::min(least, step(s));
  constexpr std::size_t kMostTold = 3;
  std::size_t gaps = 0;
  for (std::size_t s = 0; s + 1 < slices.size(); ++s) {
    constexpr double kSame = 1.5;  // digits of a decimal number may be rounded
    if (step(s) < kSame * least) continue;
    if (++gaps > kMostTold) continue;
    warnings.push_back("the slices' numbers go from " + slices[s].text + " to " +
                       slices[s + 1].text + " (" + slices[s].name + ", " + slices[s + 1].name +
                       "): what is absent there is not made up for");
  }
  if (gaps > kMostTold) {
    warnings.push_back("and " + std::to_string(gaps - kMostTold) + " more such gaps");
  }
}

SliceOrder slice_order(const std::string& folder, std::vector<std::string> files) {
  std::ranges::sort(files);
  SliceOrder order;
  if (files.size() < 2) {
    order.files = std::move(files);
    return order;
  }
  std::vector<NamedSlice> slices;
  slices.reserve(files.size());
  for (const std::string& file : files) slices.push_back(parsed(file));
  const bool numbered =
      std::ranges::any_of(slices, [](const NamedSlice& slice) { return !slice.numbers.empty(); });
  if (!numbered) {
    order.files = std::move(files);
    order.warnings.emplace_back(
        "the slices have no numbers in their names: they go by the alphabet");
    return order;
  }
  const auto refuse = [&](const NamedSlice& other) {
    throw InputError(folder, "", "slices named " + slices.front().name + " and " + other.name,
                     "names that differ in their numbers alone");
  };
  for (const NamedSlice& slice : slices) {
    if (slice.numbers.size() != slices.front().numbers.size()) refuse(slice);
  }
  take_signs(slices);
  for (const NamedSlice& slice : slices) {
    if (slice.texts != slices.front().texts) refuse(slice);
  }
  part_at_dots(folder, slices);
  std::ranges::stable_sort(slices, [](const NamedSlice& a, const NamedSlice& b) {
    return std::ranges::lexicographical_compare(a.numbers, b.numbers, less);
  });
  std::vector<std::size_t> varying;
  for (std::size_t n = 0; n < slices.front().numbers.size(); ++n) {
    const bool same = std::ranges::all_of(slices, [&](const NamedSlice& slice) {
      return slice.numbers[n] == slices.front().numbers[n];
    });
    if (!same) varying.push_back(n);
  }
  for (std::size_t s = 0; s + 1 < slices.size(); ++s) {
    if (slices[s].numbers != slices[s + 1].numbers) continue;
    throw InputError(folder, "", slices[s].name + " and " + slices[s + 1].name, "each number once");
  }
  if (varying.size() == 1) {
    std::vector<SliceNumber> numbers;
    numbers.reserve(slices.size());
    for (const NamedSlice& slice : slices) {
      const Decimal& number = slice.numbers[varying.front()];
      numbers.push_back({number.value(), number.text(), slice.name});
    }
    warn_of_gaps(numbers, order.warnings);
  } else {
    order.warnings.emplace_back(
        "the slices' names differ in several numbers: they go by the first, then by the next");
  }
  for (NamedSlice& slice : slices) order.files.push_back(std::move(slice.file));
  return order;
}

}  // namespace sulcus
