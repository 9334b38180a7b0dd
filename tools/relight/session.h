#pragma once
// An opened transfer with its scene and the changes of its varying factor; shared by apply, sweep
// and haarview.

#include <support/tool.h>

#include <renderer/transfer/relight.h>

#include <string>
#include <vector>

namespace haarlight::tool {

/// Options for the varying factor.
struct ChangeOptions {
  std::string transfer;
  std::string scene;
  std::string probe;
  std::string brdf;
};

void declare_change(Tool& app, ChangeOptions& options);

/// A transfer and its scene, files of which the options may replace.
class RelightInput {
public:
  /// @throws UsageError for options that do not fit the varying factor of the transfer
  /// @throws Error(Input)
  RelightInput(const Tool& app, const ChangeOptions& options);

  const renderer::Transfer& transfer() const { return m_transfer; }
  const renderer::SceneDescription& scene() const { return m_scene; }
  const renderer::Variation& variation() const { return m_variation; }

private:
  renderer::Transfer m_transfer;
  renderer::SceneDescription m_scene;
  renderer::Variation m_variation;
};

/// The same with a Relighter.
class RelightSession {
public:
  /// @throws as RelightInput
  RelightSession(const Tool& app, const ChangeOptions& options)
      : m_input(app, options),
        m_relighter(make_relighter(m_input.transfer(), m_input.scene(), m_input.variation())) {}

  renderer::Film make(const renderer::Change& change) { return m_relighter->make(change); }
  const renderer::Transfer& transfer() const { return m_input.transfer(); }
  const renderer::Variation& variation() const { return m_input.variation(); }

private:
  RelightInput m_input;
  std::unique_ptr<renderer::Relighter> m_relighter;
};

/// Writes R, G, B with the provenance of the transfer and of the change. @throws Error(Output)
void write_relit_exr(const std::string& path, const renderer::Film& film,
                     const renderer::Transfer& transfer, const ChangeOptions& options,
                     const renderer::Change& change);

} // namespace haarlight::tool
