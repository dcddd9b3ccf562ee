#include "reflectance/fit/fit_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "reflectance/surface/make_surface.h"
#include "reflectance/surface/surface_sum.h"

namespace gonio::fit {
namespace {

constexpr double kMostWeight = 100.0;

std::vector<std::string_view> split_terms(std::string_view text) {
  std::vector<std::string_view> terms;
  while (true) {
    const std::size_t plus = text.find('+');
    std::string_view term = text.substr(0, plus);
    while (!term.empty() && term.front() == ' ') term.remove_prefix(1);
    while (!term.empty() && term.back() == ' ') term.remove_suffix(1);
    terms.push_back(term);
    if (plus == std::string_view::npos) return terms;
    text.remove_prefix(plus + 1);
  }
}

Error unknown_formula(std::string_view text, std::string_view term) {
  std::string known;
  for (const FitFormula& formula : fit_formulas()) {
    known += (known.empty() ? "" : ", ") + std::string(formula.model);
  }
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("fit the model \"{}\"", text),
          .seen = fmt::format("\"{}\" is no model that can be fitted", term),
          .limit = "one of " + known + ", or a sum of them with +",
          .where = InputLocation{.file = {}, .field = "model"}};
}

Error bad_change(const std::string& model, const FitParameter& p, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("set {} of the model \"{}\"", p.name, model),
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{.file = {}, .field = p.name}};
}

}  // namespace

Result<FitModel> FitModel::make(std::string_view text) {
  constexpr std::size_t kMostTerms = 4;
  const std::vector<std::string_view> names = split_terms(text);
  FitModel model;
  model.name_ = std::string(text);
  if (names.size() > kMostTerms) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = fmt::format("fit the model \"{}\"", text),
                    .seen = fmt::format("{} terms", names.size()),
                    .limit = fmt::format("at most {}", kMostTerms)});
  }
  const bool is_sum = names.size() > 1;
  for (std::size_t t = 0; t < names.size(); ++t) {
    const FitFormula* formula = find_formula(names[t]);
    if (formula == nullptr) return failure(unknown_formula(text, names[t]));
    const std::string prefix = is_sum ? fmt::format("{}.", t + 1) : "";
    const bool shares_scale = is_sum && formula->is_facets;
    model.terms_.push_back({.formula = formula, .weight = model.parameters_.size()});
    model.parameters_.push_back(
        {.name = prefix + "weight", .start = 1.0, .least = 0.0, .most = kMostWeight, .is_fixed = !shares_scale});
    for (const FormulaParameter& p : formula->parameters) {
      const bool is_index = p.name == "refractive_index";
      model.parameters_.push_back({.name = prefix + std::string(p.name),
                                   .start = p.start,
                                   .least = p.least,
                                   .most = p.most,
                                   .is_fixed = p.is_fixed || (shares_scale && is_index)});
    }
  }
  model.limits_ = model.parameters_;
  return model;
}

Result<void> FitModel::change(std::string_view name, const ParameterChange& change) {
  const auto found = std::ranges::find(parameters_, name, &FitParameter::name);
  if (found == parameters_.end()) {
    std::string known;
    for (const FitParameter& p : parameters_) known += (known.empty() ? "" : ", ") + p.name;
    return failure({.code = ErrorCode::UnknownKey,
                    .tried = fmt::format("set {} of the model \"{}\"", name, name_),
                    .seen = fmt::format("there is no parameter \"{}\"", name),
                    .limit = "its parameters are " + known,
                    .where = InputLocation{.file = {}, .field = std::string(name)}});
  }
  const FitParameter& limit = limits_[static_cast<std::size_t>(found - parameters_.begin())];
  FitParameter wanted = *found;
  wanted.start = change.start.value_or(wanted.start);
  wanted.least = change.least.value_or(wanted.least);
  wanted.most = change.most.value_or(wanted.most);
  wanted.is_fixed = change.is_fixed.value_or(wanted.is_fixed);
  if (!(wanted.least >= limit.least && wanted.most <= limit.most && wanted.least < wanted.most)) {
    return failure(bad_change(name_, wanted, fmt::format("{} to {}", wanted.least, wanted.most),
                              fmt::format("a range within {} to {}", limit.least, limit.most)));
  }
  if (!(wanted.start >= wanted.least && wanted.start <= wanted.most)) {
    return failure(bad_change(name_, wanted, fmt::format("start {}", wanted.start),
                              fmt::format("{} to {}", wanted.least, wanted.most)));
  }
  *found = std::move(wanted);
  return {};
}

std::size_t FitModel::free_count() const {
  return static_cast<std::size_t>(std::ranges::count(parameters_, false, &FitParameter::is_fixed));
}

double FitModel::value(const PairTerms& pair, std::span<const double> x, std::span<double> slopes) const {
  double sum = 0.0;
  for (const Term& term : terms_) {
    const std::size_t first = term.weight + 1;
    const std::size_t count = term.formula->parameters.size();
    const double weight = x[term.weight];
    const Dual f = term.formula->value(pair, x.subspan(first, count));
    sum += weight * f.v;
    slopes[term.weight] = f.v;
    for (std::size_t k = 0; k < count; ++k) slopes[first + k] = weight * f.d[k];
  }
  return sum;
}

Result<reflectance::Surface> FitModel::surface(std::span<const double> x) const {
  std::vector<reflectance::SurfaceTerm> terms;
  for (const Term& term : terms_) {
    reflectance::Parameters parameters;
    for (std::size_t k = 0; k < term.formula->parameters.size(); ++k) {
      parameters.push_back({std::string(term.formula->parameters[k].name), x[term.weight + 1 + k]});
    }
    Result<reflectance::Surface> made = reflectance::make_surface(term.formula->model, parameters);
    if (!made) return made;
    terms.push_back({*std::move(made), x[term.weight]});
  }
  if (terms.size() == 1 && terms[0].weight == 1.0) return terms[0].surface;
  Result<reflectance::SurfaceSum> sum = reflectance::SurfaceSum::make(std::move(terms));
  if (!sum) return failure(std::move(sum).error());
  return reflectance::Surface(*std::move(sum));
}

}  // namespace gonio::fit
