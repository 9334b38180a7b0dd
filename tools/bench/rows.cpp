#include <bench/rows.h>

#include <support/words.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace haarlight::bench {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos)
    return text;
  std::string result = "\"";
  for (const char c : text)
    result.append(c == '"' ? 2 : 1, c);
  return result.append("\"");
}

std::string csv_value(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value))
    return quoted(*text);
  if (const auto* number = std::get_if<std::int64_t>(&value))
    return std::to_string(*number);
  const double real = std::get<double>(value);
  return std::isfinite(real) ? tool::exact_text(real) : std::string();
}

} // namespace

std::vector<std::pair<std::string, Value>> fields_of(const Row& row) {
  return {{"brdf", row.brdf},
          {"probe", row.probe},
          {"scene", row.scene},
          {"sampler", row.sampler},
          {"points", row.points},
          {"spp", std::int64_t{row.spp}},
          {"seconds", row.seconds},
          {"seed_count", std::int64_t{row.seed_count}},
          {"relmse", row.relmse},
          {"relvar_per_sample", row.relvar_per_sample},
          {"mean_ratio", row.mean_ratio},
          {"mean_ratio_stderr", row.mean_ratio_stderr},
          {"seconds_per_sample", row.seconds_per_sample},
          {"setup_seconds", row.setup_seconds},
          {"mode", row.mode},
          {"budget_seconds", row.budget_seconds},
          {"efficiency", row.efficiency},
          {"slope", row.slope},
          {"relmse_stderr", row.relmse_stderr},
          {"reference_relmse", row.reference_relmse},
          {"seconds_per_point", row.seconds_per_point},
          {"precompute_seconds", row.precompute_seconds},
          {"claim", row.claim}};
}

std::string json_text(const std::vector<Row>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    nlohmann::ordered_json object;
    for (const auto& [name, value] : fields_of(row))
      std::visit([&, &key = name](const auto& v) { object[key] = v; }, value);
    list.push_back(std::move(object));
  }
  return list.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

std::string csv_text(const std::vector<Row>& rows) {
  std::string text;
  for (const auto& [name, value] : fields_of({}))
    text.append(text.empty() ? "" : ",").append(name);
  text += '\n';
  for (const Row& row : rows) {
    std::string line;
    for (const auto& [name, value] : fields_of(row))
      line.append(name == "brdf" ? "" : ",").append(csv_value(value));
    text.append(line).append("\n");
  }
  return text;
}

} // namespace haarlight::bench
