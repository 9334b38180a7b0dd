#include <view/frame_output.h>

#include <support/arguments.h>

#include <image/image_exr.h>
#include <image/png.h>

namespace haarlight::view {

void write_frame(const Options& options, const DrawnFrame& frame, int width, int height) {
  Image picture(width, height);
  picture.rgb = frame.rgb;
  if (tool::has_extension(options.frame, ".png"))
    image::write_png(options.frame, picture, {options.exposure, image::ToneMap::Filmic});
  else
    image::write_exr(options.frame, picture);
}

} // namespace haarlight::view
