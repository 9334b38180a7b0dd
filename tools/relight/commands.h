#pragma once
// The commands of haarrelight, one source file each.

#include <support/commands.h>

namespace haarlight::tool {

Command build_command();
Command apply_command();
Command sweep_command();

} // namespace haarlight::tool
