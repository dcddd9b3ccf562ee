#include "daemon/analysis/model_text.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "reflectance/surface/make_surface.h"
#include "reflectance/surface/surface_sum.h"

namespace gonio::analysis {
namespace {

using reflectance::Surface;
using reflectance::SurfaceTerm;

Error bad_word(std::string_view word, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .device = "analysis",
          .tried = "read a model",
          .seen = fmt::format("\"{}\"", word),
          .limit = std::move(limit),
          .where = InputLocation{"", 0, "model"}};
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return words;
    const std::size_t end = std::min(text.find_first_of(" \t", begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    text.remove_prefix(end);
  }
}

std::optional<double> number_of(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// [WEIGHT *] MODEL [NAME=VALUE ...]
Result<SurfaceTerm> term_of(const std::vector<std::string_view>& words) {
  std::size_t at = 0;
  double weight = 1.0;
  if (words.size() > 2 && words[1] == "*") {
    const auto number = number_of(words[0]);
    if (!number) return failure(bad_word(words[0], "a weight, as in \"0.5 * lambertian rho=1\""));
    weight = *number;
    at = 2;
  }
  if (at == words.size()) return failure(bad_word("", "a model and its numbers, as in \"lambertian rho=0.5\""));
  const std::string_view model = words[at];
  reflectance::Parameters parameters;
  for (++at; at < words.size(); ++at) {
    const std::size_t sign = words[at].find('=');
    const auto number = sign == std::string_view::npos ? std::nullopt : number_of(words[at].substr(sign + 1));
    if (!number) return failure(bad_word(words[at], "a number by its name, as in \"rho=0.5\""));
    parameters.push_back({.name = std::string(words[at].substr(0, sign)), .value = *number});
  }
  Result<Surface> surface = reflectance::make_surface(model, parameters);
  if (!surface) return failure(std::move(surface).error());
  return SurfaceTerm{.surface = *std::move(surface), .weight = weight};
}

std::string text_of_model(const Surface& surface) {
  std::string text(surface.model());
  for (const reflectance::NamedNumber& p : surface.parameters()) text += fmt::format(" {}={:.8g}", p.name, p.value);
  return text;
}

}  // namespace

Result<Surface> surface_of_text(std::string_view text) {
  std::vector<SurfaceTerm> terms;
  std::vector<std::string_view> words;
  std::vector<std::string_view> all = words_of(text);
  all.emplace_back("+");
  for (const std::string_view word : all) {
    if (word != "+") {
      words.push_back(word);
      continue;
    }
    Result<SurfaceTerm> term = term_of(words);
    if (!term) return failure(std::move(term).error());
    terms.push_back(*std::move(term));
    words.clear();
  }
  if (terms.size() == 1 && terms[0].weight == 1.0) return terms[0].surface;
  Result<reflectance::SurfaceSum> sum = reflectance::SurfaceSum::make(std::move(terms));
  if (!sum) return failure(std::move(sum).error());
  return Surface(*std::move(sum));
}

std::string text_of_surface(const Surface& surface) {
  if (surface.terms().empty()) return text_of_model(surface);
  std::string text;
  for (const SurfaceTerm& term : surface.terms()) {
    text += fmt::format("{}{} * {}", text.empty() ? "" : " + ", term.weight, text_of_model(term.surface));
  }
  return text;
}

}  // namespace gonio::analysis
