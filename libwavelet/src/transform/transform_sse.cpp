#include "transform/haar_tile.h"

namespace haarlight::wavelet::haar {

template struct TileTransform<16>;

} // namespace haarlight::wavelet::haar
