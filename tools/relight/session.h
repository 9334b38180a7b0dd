#pragma once
// What `apply` and `sweep` share: an opened transfer with its scene, and what is changed.

#include <support/tool.h>

#include <renderer/relight.h>

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

/// A transfer, its scene, and what makes pictures of them.
class RelightSession {
public:
  /// @throws UsageError if what is asked for does not vary in the transfer
  /// @throws Error(Input)
  RelightSession(const Tool& app, const ChangeOptions& options);

  renderer::Film make(const renderer::Change& change) { return m_relighter->make(change); }
  const renderer::Transfer& transfer() const { return m_transfer; }
  const renderer::Variation& variation() const { return m_variation; }

private:
  renderer::Transfer m_transfer;
  renderer::SceneDescription m_scene;
  renderer::Variation m_variation;
  std::unique_ptr<renderer::Relighter> m_relighter;
};

/// Writes R, G, B with the transfer's provenance and what was changed. @throws Error(Output)
void write_relit_exr(const std::string& path, const renderer::Film& film,
                     const renderer::Transfer& transfer, const ChangeOptions& options,
                     const renderer::Change& change);

} // namespace haarlight::tool
