#include "transform/haar_tile.h"

namespace haarlight::wavelet::haar {

template struct TileTransform<64>;

} // namespace haarlight::wavelet::haar
