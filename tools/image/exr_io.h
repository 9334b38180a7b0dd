#pragma once
// OpenEXR over the toolkit's files: streams, threads, errors, and the choice and reading of
// colours. For the sources of this folder only: it shows OpenEXR's headers.

#include <wavelet/base/error.h>
#include <wavelet/base/image.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/output_file.h>

#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace haarlight::image {

/// Writes into an OutputFile. OpenEXR swallows errors while it closes a file, so the first one is
/// kept and nothing is written after it.
class ExrOutputStream : public Imf::OStream {
public:
  explicit ExrOutputStream(OutputFile& file);

  void write(const char bytes[], int count) override;
  std::uint64_t tellp() override { return m_file.position(); }
  void seekp(std::uint64_t position) override { m_file.seek(position); }

  /// Bytes of the file so far.
  std::uint64_t size() const { return m_size; }

  /// @throws Error(Output), the first that occurred
  void rethrow() const;

private:
  OutputFile& m_file;
  std::optional<Error> m_error;
  std::uint64_t m_size = 0;
};

/// Gives OpenEXR as many threads as parallel_for uses, or none where the system refuses them.
/// @return their number
int start_exr_threads();

/// Reads from the bytes of a file, which must outlive it. OpenEXR gets copies: in a memory-mapped
/// stream it reads past the end of chunks that are shorter than their pixels.
class ExrInputStream : public Imf::IStream {
public:
  explicit ExrInputStream(const InputFile& file);

  bool read(char bytes[], int count) override;
  std::uint64_t tellg() override { return m_position; }
  void seekg(std::uint64_t position) override { m_position = position; }

private:
  std::span<const std::byte> m_bytes;
  std::uint64_t m_position = 0;
};

/// Calls `body`; converts exceptions of OpenEXR to Error(Input) for `path`.
template <class F>
auto with_input_errors(const std::string& path, F&& body) {
  try {
    return body();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw_input_error(path, std::string("cannot be decoded: ") + error.what());
  }
}

/// The channels that hold red, green and blue; a grey image has one for all three.
struct RgbChannels {
  std::array<std::string, 3> names;

  bool grey() const { return names[0] == names[1]; }
};

/// R, G and B; else those of the only layer that has all three (`beauty.R` …); else Y.
/// @throws Error(Input) that lists the channels if there are none or several such layers, and for
///         channels that are subsampled or of integers, luminance with chroma, and
///         chromaticities other than those of Rec. 709
RgbChannels choose_channels(const Imf::Header& header, const std::string& path);

/// The size of the display window, which is the picture.
/// @throws Error(Input) if it is empty, too large, or shows nothing of the data window
Imath::V2i display_size(const Imf::Header& header, const std::string& path);

/// The picture in the display window: pixels outside of the data window are black.
/// @param header that of the file, by read_exr_header()
/// @throws Error(Input)
Image read_rgb(const InputFile& file, const Imf::Header& header);

/// Copies the first channel of grey pixels to the other two.
void spread_grey(std::vector<float>& rgb);

} // namespace haarlight::image
