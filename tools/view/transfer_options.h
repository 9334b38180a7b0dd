#pragma once
// The part of haarview's command line that is about transfer.

#include <support/tool.h>

#include <string>
#include <vector>

namespace haarlight::view {

/// As haarrelight apply has them.
struct TransferOptions {
  std::string scene;
  std::string light;
  std::vector<double> rotate = {0, 0, 0};
};

void declare_transfer(tool::Tool& app, TransferOptions& options);

/// Refuses options that a transfer does not take. @throws UsageError
void check_transfer(const tool::Tool& app);

/// Refuses options that only a transfer takes. @throws UsageError
void check_scene(const tool::Tool& app);

} // namespace haarlight::view
