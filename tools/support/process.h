#pragma once
// What a program arranges with the system before it works: signals, standard descriptors, and the
// last resort for errors that nothing catches.

#include <string>

namespace haarlight::tool {

/// Call once, before threads are started and files opened.
/// - INT, TERM, HUP, QUIT and XCPU remove temporaries and then end the process by the same signal,
///   so that a shell sees the exit code 128 + N. A signal that is ignored, as under nohup, stays
///   so.
/// - PIPE and XFSZ are ignored: a closed pipe and a file size limit are output errors.
/// - Closed standard descriptors are taken, so that no output file becomes one of them.
/// - std::terminate prints one line, `name: …`, removes temporaries and exits with code 5.
void prepare_process(const std::string& name);

} // namespace haarlight::tool
