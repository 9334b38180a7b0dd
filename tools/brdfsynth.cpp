// brdfsynth: MERL-format files of analytic reflectance models.
#include <support/tool.h>

#include <brdf/brdf_properties.h>
#include <brdf/tabulate.h>

#include <algorithm>

using namespace haarlight;

namespace {

enum class Model { Ggx, BlinnPhong, Ward, Lafortune, AshikhminShirley };

struct Options {
  Model model = Model::Ggx;
  std::vector<double> diffuse;
  std::vector<double> specular;
  std::optional<double> roughness, exponent, lobe_xy, lobe_z;
  brdf::TabulateOptions table;
  std::string output;
};

void declare(tool::Tool& app, Options& o) {
  app.choice(o.model, "--model",
             {{"ggx", Model::Ggx},
              {"blinn-phong", Model::BlinnPhong},
              {"ward", Model::Ward},
              {"lafortune", Model::Lafortune},
              {"ashikhmin-shirley", Model::AshikhminShirley}},
             "Reflectance model");
  app.require("--model");
  app.output(o.output, "OUT.binary", "MERL file to write");
  app.values(o.diffuse, "--diffuse", "Diffuse albedo R,G,B [0,0,0]", 3, 0, 1);
  app.values(o.specular, "--specular",
             "Specular colour R,G,B: reflectance at normal incidence [0.04 ggx, 0.05 "
             "ashikhmin-shirley, else 0.5]",
             3, 0, 1);
  app.value(o.roughness, "--roughness", "Roughness of ggx and ward [0.2]", 1e-3, 1);
  app.value(o.exponent, "--exponent",
            "Cosine exponent of blinn-phong and ashikhmin-shirley [100] and lafortune [40]", 1e-3,
            1e6);
  app.value(o.lobe_xy, "--lobe-xy", "Lafortune's C_xy; positive = retroreflective [-1]", -10, 10);
  app.value(o.lobe_z, "--lobe-z", "Lafortune's C_z [1]", -10, 10);
  app.value(o.table.noise, "--noise",
            "Standard deviation of multiplicative noise per cell, relative", 0, 2);
  app.value(o.table.seed, "--seed", "Random seed of the noise");
  app.offer_json();
}

void set_colour(Rgb& colour, const std::vector<double>& given) {
  for (int c = 0; c < static_cast<int>(given.size()); ++c)
    colour[c] = static_cast<float>(given[static_cast<std::size_t>(c)]);
}

/// Sets a parameter of the model. @param parameter null if the model lacks it
void set_number(double* parameter, const std::optional<double>& given, const char* option) {
  if (given && parameter == nullptr)
    throw tool::UsageError(std::string(option) + " is not a parameter of this model");
  if (given)
    *parameter = *given;
}

template <class M>
brdf::AnalyticBrdf configured(M model, const Options& o) {
  set_colour(model.diffuse, o.diffuse);
  set_colour(model.specular, o.specular);
  double* roughness = nullptr;
  double* exponent = nullptr;
  double* lobe_xy = nullptr;
  double* lobe_z = nullptr;
  if constexpr (requires { model.roughness; })
    roughness = &model.roughness;
  if constexpr (requires { model.exponent; })
    exponent = &model.exponent;
  if constexpr (requires { model.c_xy; }) {
    lobe_xy = &model.c_xy;
    lobe_z = &model.c_z;
  }
  set_number(roughness, o.roughness, "--roughness");
  set_number(exponent, o.exponent, "--exponent");
  set_number(lobe_xy, o.lobe_xy, "--lobe-xy");
  set_number(lobe_z, o.lobe_z, "--lobe-z");
  return model;
}

brdf::AnalyticBrdf model_of(const Options& o) {
  switch (o.model) {
  case Model::BlinnPhong:
    return configured(brdf::BlinnPhong{}, o);
  case Model::Ward:
    return configured(brdf::Ward{}, o);
  case Model::Lafortune:
    return configured(brdf::Lafortune{}, o);
  case Model::AshikhminShirley:
    return configured(brdf::AshikhminShirley{}, o);
  case Model::Ggx:
    break;
  }
  return configured(brdf::Ggx{}, o);
}

tool::Report describe(const brdf::MerlTable& table, const std::string& path) {
  const auto begin = table.raw.begin();
  const auto invalid = std::count_if(begin, begin + static_cast<std::ptrdiff_t>(table.plane_size()),
                                     [](double value) { return value < 0; });
  const brdf::MeasuredBrdf lookup(table);
  std::vector<double> albedo;
  for (const double degrees : {0, 30, 60})
    albedo.push_back(static_cast<double>(
        luminance(brdf::directional_albedo(lookup, degrees * pi / 180, degrees * pi / 180))));
  tool::Report report;
  report.add("cells", table.plane_size())
      .add("invalid_cells", invalid)
      .add("luminance_albedo_at_0_30_60_degrees", albedo)
      .add("output", path);
  return report;
}

int write_table(const tool::Tool& app, const Options& options) {
  const brdf::MerlTable table = brdf::tabulate(model_of(options), options.table);
  brdf::write_merl(options.output, table);
  app.print(describe(table, options.output));
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command("brdfsynth",
                    "Writes an analytic reflectance model as a MERL file: f_r in 1/sr at bin "
                    "centres, invalid cells marked as in measurements.",
                    declare, write_table));
}
