#include <image/exr_stream.h>

#include <wavelet/base/parallel.h>

#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfThreading.h>

#include <Iex.h>

#include <algorithm>
#include <cstring>
#include <system_error>

namespace haarlight::image {

ExrOutputStream::ExrOutputStream(OutputFile& file)
    : Imf::OStream(file.path().c_str()), m_file(file) {}

void ExrOutputStream::write(const char bytes[], int count) {
  if (m_error)
    return;
  try {
    m_file.write(bytes, static_cast<std::size_t>(count));
    m_size = std::max(m_size, m_file.position());
  } catch (const Error& error) {
    m_error = error;
  }
}

void ExrOutputStream::rethrow() const {
  if (m_error)
    throw Error(*m_error);
}

int start_exr_threads() {
  try {
    Imf::setGlobalThreadCount(thread_count());
    return thread_count();
  } catch (const std::system_error&) {
    Imf::setGlobalThreadCount(0);
    return 0;
  }
}

ExrInputStream::ExrInputStream(const InputFile& file)
    : Imf::IStream(file.path().c_str()), m_bytes(file.bytes()) {}

bool ExrInputStream::read(char bytes[], int count) {
  const auto wanted = static_cast<std::uint64_t>(count);
  if (count < 0 || m_position > m_bytes.size() || wanted > m_bytes.size() - m_position)
    throw Iex::InputExc("the file ends too early");
  std::memcpy(bytes, m_bytes.data() + m_position, wanted);
  m_position += wanted;
  return m_position < m_bytes.size();
}

void check_exr_complete(const std::string& temporary_path) {
  try {
    Imf::InputFile file(temporary_path.c_str());
    if (file.isComplete())
      return;
  } catch (const std::exception&) { // NOLINT(bugprone-empty-catch): said below
  }
  throw_output_error(temporary_path, "is incomplete after writing");
}

} // namespace haarlight::image
