#pragma once
// What `apply` and `sweep` share: an opened transfer with its scene, and what is changed.

#include <support/tool.h>

#include <renderer/transfer/relight.h>

#include <string>
#include <vector>

namespace haarlight::tool {

/// The options that say what the varying factor becomes.
struct ChangeOptions {
  std::string transfer;
  std::string scene;
  std::string light;
  std::string brdf;
};

void declare_change(Tool& app, ChangeOptions& options);

/// A transfer and its scene, with the files that take the place of the scene's own.
class RelightInput {
public:
  /// @throws UsageError if what is asked for does not vary in the transfer
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

/// The same with what makes pictures of them.
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

/// Writes R, G, B with the transfer's provenance and what was changed. @throws Error(Output)
void write_relit_exr(const std::string& path, const renderer::Film& film,
                     const renderer::Transfer& transfer, const ChangeOptions& options,
                     const renderer::Change& change);

} // namespace haarlight::tool
