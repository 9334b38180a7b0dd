#include <image/exposure.h>

#include <algorithm>

namespace haarlight::image {

float middle_grey_gain(const Picture& picture) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
    sum += std::max(0.0,
                    static_cast<double>(luminance(Eigen::Map<const Rgb>(picture.rgb.data() + i))));
  return sum > 0 ? static_cast<float>(0.06 * static_cast<double>(picture.rgb.size()) / sum) : 1.0F;
}

void brighten(Picture& picture, float gain) {
  for (float& value : picture.rgb)
    value *= gain;
}

} // namespace haarlight::image
