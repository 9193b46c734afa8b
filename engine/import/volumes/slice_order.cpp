#include "engine/import/volumes/slice_order.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
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
  bool operator==(const Decimal&) const = default;
};

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
      number.fraction = stem.substr(end + 1, fraction_end - end - 1);
      while (!number.fraction.empty() && number.fraction.back() == '0') number.fraction.pop_back();
      end = fraction_end;
    }
    number.whole.erase(0, std::min(number.whole.find_first_not_of('0'), number.whole.size()));
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

void warn_of_gaps(const std::vector<NamedSlice>& slices, std::size_t varying,
                  std::vector<std::string>& warnings) {
  double least = std::numeric_limits<double>::infinity();
  const auto step = [&](std::size_t s) {
    return slices[s + 1].numbers[varying].value() - slices[s].numbers[varying].value();
  };
  for (std::size_t s = 0; s + 1 < slices.size(); ++s) least = std::min(least, step(s));
  constexpr std::size_t kMostTold = 3;
  std::size_t gaps = 0;
  for (std::size_t s = 0; s + 1 < slices.size(); ++s) {
    constexpr double kSame = 1.5;  // digits of a decimal number may be rounded
    if (step(s) < kSame * least) continue;
    if (++gaps > kMostTold) continue;
    warnings.push_back("the slices' numbers go from " + slices[s].numbers[varying].text() + " to " +
                       slices[s + 1].numbers[varying].text() + " (" + slices[s].name + ", " +
                       slices[s + 1].name + "): what is absent there is not made up for");
  }
  if (gaps > kMostTold) {
    warnings.push_back("and " + std::to_string(gaps - kMostTold) + " more such gaps");
  }
}

}  // namespace

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
    warn_of_gaps(slices, varying.front(), order.warnings);
  } else {
    order.warnings.emplace_back(
        "the slices' names differ in several numbers: they go by the first, then by the next");
  }
  for (NamedSlice& slice : slices) order.files.push_back(std::move(slice.file));
  return order;
}

}  // namespace sulcus
